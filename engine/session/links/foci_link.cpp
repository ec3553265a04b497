#include "session/links/foci_link.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/udp.hpp"

namespace palpa::session {
namespace {

constexpr const char* form = "link foci takes udp:HOST:PORT, for example foci:udp:127.0.0.1:9000";

class FociLink : public Link {
 public:
  FociLink(const std::string& address, const LinkSetting& setting)
      : sender_(address, "link foci", form), solid_names_(setting.solid_names.begin(), setting.solid_names.end()) {}

  void plan(const PlayedPlan& plan) override {
    once_ = plan.schedule.once && plan.schedule.voice_count > 0;
    if (once_) {  // its lines go out slot by slot
      schedule_ = plan.schedule;
      return;
    }
    if (plan.schedule.voice_count == 0 && plan.schedule.time_s < last_s_) {  // after lines of slots
      heard_ = send_silence() == UdpSender::Sent::yes;
      return;
    }
    const std::vector<std::string>& names = plan.schedule.solid_names ? *plan.schedule.solid_names : solid_names_;
    const bool whole = write_foci_line(plan.schedule, plan.slots, names, json_);
    last_s_ = plan.schedule.time_s;
    send_line(plan.schedule.voice_count > 0);
    if (heard_ && !whole && !std::exchange(told_, true)) warn_of_cut_gains("link foci");
  }
  /// A drive counts as played if its line of foci was sent, and nobody refused it.
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    if (once_) send_slot(slot, sounds(drive));
    played_ += heard_ && sounds(drive) ? 1 : 0;
  }
  std::optional<Carried> carried() const override {
    return Carried{.completed = {.drives = played_, .plans = lines_with_fingers_}};
  }
  void finish() override {
    for (int repeat = 0; repeat < 3; ++repeat) {  // the last line may get lost like any other
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      send_silence();
    }
    if (unsent_ > 0) {
      log::warning(
          fmt::format("link foci: {} of {} lines could not be sent; there was silence instead", unsent_, lines_));
    }
    if (refused_ > 0) log::warning(fmt::format("link foci: {} of {} lines had no receiver", refused_, lines_));
  }

 private:
  void send_slot(std::uint64_t slot, bool audible) {
    array::foci_of_slot(schedule_, slot, foci_);
    array::Schedule line;
    line.slot_s = schedule_.slot_s;
    line.time_s = static_cast<double>(slot) * schedule_.slot_s;
    for (const array::SlotFocus& focus : foci_) {
      array::Voice& voice = line.add_voice();
      voice.foci = {focus.position};
      voice.order = {0};
      voice.dwell_s = schedule_.slot_s;
      voice.gain = audible ? static_cast<double>(focus.gain) : 0;
    }
    write_foci_line(line, {}, solid_names_, json_);
    last_s_ = line.time_s;
    send_line(true);
  }
  void send_line(bool has_fingers) {
    ++lines_;
    const UdpSender::Sent sent = sender_.send(json_.finish());
    heard_ = sent == UdpSender::Sent::yes;
    lines_with_fingers_ += heard_ && has_fingers ? 1 : 0;
    refused_ += sent == UdpSender::Sent::refused ? 1 : 0;
    if (sent == UdpSender::Sent::no) {
      ++unsent_;
      send_silence();  // otherwise, the foci of the previous line would continue to sound
    }
    sender_.warn();
  }
  UdpSender::Sent send_silence() {
    array::Schedule nothing;
    nothing.time_s = last_s_;
    write_foci_line(nothing, {}, {}, json_);
    return sender_.send(json_.finish());
  }

  UdpSender sender_;
  std::vector<std::string> solid_names_;
  JsonWriter json_;
  bool once_ = false;         ///< the foci of the plan belong to slots
  array::Schedule schedule_;  ///< that plan's
  std::vector<array::SlotFocus> foci_;
  double last_s_ = 0;  ///< time of the last line
  std::uint64_t lines_ = 0, unsent_ = 0, refused_ = 0;
  bool heard_ = false;  ///< the last line was sent
  bool told_ = false;   ///< of gains that are cut
  std::uint64_t played_ = 0, lines_with_fingers_ = 0;
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

namespace {

void write_gains(const array::Course& course, std::uint64_t from, std::uint64_t count, double slot_s,
                 JsonWriter& json) {
  json.member("slot_s", slot_s).key("gains").begin_array();
  for (std::uint64_t slot = from; slot < from + count; ++slot)
    json.value(array::modulate(course, slot, slot_s));
  json.end_array();
}

}  // namespace

bool write_foci_line(const array::Schedule& schedule, const Slots& slots, std::span<const std::string> solid_names,
                     JsonWriter& json) {
  const std::uint64_t gains = std::min(slots.count(), most_gains / std::max(schedule.voice_count, 1U));
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
    if (voice.modulation_hz != 0) json.member("modulation", word_of(array::modulation_words, voice.modulation));
    json.member("gain", voice.gain);
    if (voice.course.changes() && gains > 0) write_gains(voice.course, slots.from, gains, schedule.slot_s, json);
    if (voice.reached_pa) json.member("pressure_pa", *voice.reached_pa);
    json.end_object();
  }
  json.end_array().end_object();
  return gains == slots.count() || !array::changes(schedule);
}

void warn_of_cut_gains(const std::string& name) {
  log::warning(
      fmt::format("{}: a line has at most {} gains that change, fewer than it may play: the last one stays "
                  "until the next line; give a longer dwell or a shorter hold",
                  name, most_gains));
}

std::unique_ptr<Link> open_foci_link(const std::string& argument, const LinkSetting& setting) {
  if (!argument.starts_with("udp:")) throw bad_usage(form);
  if (setting.nulls)
    throw bad_usage("link foci sends foci and no drives, so its receiver would leave no null silent: leave --null out");
  return std::make_unique<FociLink>(argument.substr(4), setting);
}

}  // namespace palpa::session
