#include "session/foci_link.hpp"

#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "session/udp.hpp"

namespace palpa::session {
namespace {

constexpr const char* form = "link foci takes udp:HOST:PORT, for example foci:udp:127.0.0.1:9000";

class FociLink : public Link {
 public:
  FociLink(const std::string& address, const LinkSetting& setting)
      : sender_(address, "link foci", form), solid_names_(setting.solid_names.begin(), setting.solid_names.end()) {}

  void foci(const array::Schedule& schedule) override {
    write_foci_line(schedule, solid_names_, json_);
    sender_.send(json_.finish());
  }
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}

 private:
  UdpSender sender_;
  std::vector<std::string> solid_names_;
  JsonWriter json_;
};

}  // namespace

void write_order(const array::Voice& voice, JsonWriter& json) {
  if (voice.foci_per_slot <= 1) {
    json.value(voice.order);
    return;
  }
  json.begin_array();
  const std::span<const std::uint32_t> order = voice.order;
  for (std::size_t at = 0; at + voice.foci_per_slot <= order.size(); at += voice.foci_per_slot)
    json.value(order.subspan(at, voice.foci_per_slot));
  json.end_array();
}

void write_foci_line(const array::Schedule& schedule, std::span<const std::string> solid_names, JsonWriter& json) {
  json.clear();
  json.begin_object(JsonWriter::Style::compact).member("time_s", schedule.time_s);
  json.key("fingers").begin_array();
  for (std::uint32_t v = 0; v < schedule.voice_count; ++v) {
    const array::Voice& voice = schedule.voices[v];
    json.begin_object().member("id", voice.id).key("solid");
    json.value(voice.solid < solid_names.size() ? std::string_view(solid_names[voice.solid]) : "");
    json.key("foci_m").begin_array();
    for (const Vec3& focus : voice.foci)
      json.value(glm::vec3(focus));
    json.end_array();
    json.key("order");
    write_order(voice, json);
    json.member("dwell_s", voice.dwell_s).member("modulation_hz", voice.modulation_hz);
    if (voice.modulation_hz != 0) json.member("modulation", array::name_of(voice.modulation));
    json.member("gain", voice.gain);
    json.end_object();
  }
  json.end_array().end_object();
}

std::unique_ptr<Link> open_foci_link(const std::string& argument, const LinkSetting& setting) {
  if (!argument.starts_with("udp:")) throw bad_usage(form);
  return std::make_unique<FociLink>(argument.substr(4), setting);
}

}  // namespace palpa::session
