#include "session/foci_link.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::session {
namespace {

class FociLink : public Link {
 public:
  FociLink(int socket, const LinkSetting& setting)
      : socket_(socket), solid_names_(setting.solid_names.begin(), setting.solid_names.end()) {}
  ~FociLink() override { ::close(socket_); }
  FociLink(const FociLink&) = delete;
  FociLink& operator=(const FociLink&) = delete;

  void foci(const array::Schedule& schedule) override {
    write_foci_line(schedule, solid_names_, json_);
    const std::string_view line = json_.finish();
    // Nobody listening is no fault of the sender's: a receiver may come and go. The kernel tells of it at the send
    // after, which is then not made; so it is made again.
    const bool sent = try_send(line) || (errno == ECONNREFUSED && try_send(line));
    if (!sent && errno != ECONNREFUSED && !warned_) {
      warned_ = true;
      log::warning(fmt::format("link foci: a frame could not be sent: {}", std::strerror(errno)));
    }
  }
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}

 private:
  /// Never blocks: the output thread has drives to send.
  bool try_send(std::string_view line) const {
    return ::send(socket_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0;
  }

  int socket_;
  std::vector<std::string> solid_names_;
  JsonWriter json_;
  bool warned_ = false;
};

int connect_udp(const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int fault = getaddrinfo(host.c_str(), port.c_str(), &hints, &found)) {
    throw failure(fmt::format("link foci: {}:{} does not resolve: {}", host, port, gai_strerror(fault)));
  }
  int connected = -1;
  for (const addrinfo* address = found; address && connected < 0; address = address->ai_next) {
    const int candidate = ::socket(address->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (candidate < 0) continue;
    if (::connect(candidate, address->ai_addr, address->ai_addrlen) == 0) {
      connected = candidate;
    } else {
      ::close(candidate);
    }
  }
  freeaddrinfo(found);
  if (connected < 0)
    throw failure(fmt::format("link foci: cannot send to {}:{}: {}", host, port, std::strerror(errno)));
  return connected;
}

}  // namespace

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
    json.member("order", voice.order).member("dwell_s", voice.dwell_s).member("modulation_hz", voice.modulation_hz);
    json.end_object();
  }
  json.end_array().end_object();
}

std::unique_ptr<Link> open_foci_link(const std::string& argument, const LinkSetting& setting) {
  const std::string form = "link foci takes udp:HOST:PORT, for example foci:udp:127.0.0.1:9000";
  const std::size_t last = argument.rfind(':');
  if (argument.rfind("udp:", 0) != 0 || last <= 4) throw bad_usage(form);
  std::string host = argument.substr(4, last - 4);
  const std::string port = argument.substr(last + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  const bool digits = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty() || !digits || std::stoi(port) < 1 || std::stoi(port) > 65535) throw bad_usage(form);
  return std::make_unique<FociLink>(connect_udp(host, port), setting);
}

}  // namespace palpa::session
