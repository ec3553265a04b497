// Frames that a tracker's program sends to a port of this computer, one in each datagram. The newest frame wins.
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/error.hpp"
#include "base/log.hpp"
#include "sensing/joints/hand_check.hpp"
#include "sensing/joints/left_out.hpp"
#include "sensing/joints/read_frame.hpp"
#include "sensing/joints/tracker.hpp"

namespace palpa::sensing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* form = "source joints takes udp:PORT or udp:HOST:PORT, for example joints:udp:9000";
constexpr std::size_t most_datagram = 65536;
/// At one time, so many datagrams are taken from the system, and of these the newest few are read.
constexpr int most_taken = 64;
constexpr std::size_t most_read = 4;
/// A frame that is older than the one before by more than this is of a tracker that was started again.
constexpr double longest_delay_s = 1;
const std::string its_name = "the datagram";

int listen_udp(const std::string& source, const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int fault = getaddrinfo(host.c_str(), port.c_str(), &hints, &found))
    throw failure(fmt::format("{}: {} does not resolve: {}", source, host, gai_strerror(fault)));
  int bound = -1, last_fault = 0;
  for (const addrinfo* address = found; address && bound < 0; address = address->ai_next) {
    const int candidate = ::socket(address->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (candidate >= 0 && ::bind(candidate, address->ai_addr, address->ai_addrlen) == 0) {
      bound = candidate;
    } else {
      last_fault = errno;
      if (candidate >= 0) ::close(candidate);
    }
  }
  freeaddrinfo(found);
  if (bound < 0)
    throw failure(fmt::format("{}: cannot listen on port {} of {}: {}", source, port, host, std::strerror(last_fault)));
  return bound;
}

int open_port(const std::string& source, const std::string& address) {
  const std::size_t colon = address.rfind(':');
  std::string host = colon == std::string::npos ? "127.0.0.1" : address.substr(0, colon);
  const std::string port = colon == std::string::npos ? address : address.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  const bool digits = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty() || !digits || std::stoi(port) < 1 || std::stoi(port) > 65535) throw bad_usage(form);
  return listen_udp(source, host, port);
}

class UdpTracker final : public Tracker {
 public:
  explicit UdpTracker(const std::string& address)
      : source_("joints:udp:" + address), socket_(open_port(source_, address)), buffer_(most_datagram, 0) {}
  ~UdpTracker() override {
    ::close(socket_);
    if (replaced_ > 0) log::info(fmt::format("{}: {} datagrams were left out for newer ones", source_, replaced_));
  }
  UdpTracker(const UdpTracker&) = delete;
  UdpTracker& operator=(const UdpTracker&) = delete;

  bool next(TrackedFrame& out, bool& came, std::uint64_t& number, double timeout_s) override {
    const std::chrono::duration<double> timeout(std::max(timeout_s, 0.0));
    const Clock::time_point until = Clock::now() + std::chrono::duration_cast<Clock::duration>(timeout);
    came = false;
    do {
      if (!wait_until(until)) break;
      const std::size_t taken = take();
      for (std::size_t i = 0; i < std::min(taken, most_read) && !came; ++i)
        came = read(newest_[(taken - 1 - i) % most_read], out);
      if (came) number_ += taken;
      if (taken > 0) replaced_ += taken - 1;
    } while (!came && Clock::now() < until);
    if (!came) return true;
    number = number_ - 1;
    if (const auto doubt = check_.check(out)) left_out_.add(to_text(*doubt));
    return true;
  }

 private:
  /// Whether a datagram is there.
  bool wait_until(Clock::time_point until) const {
    const double rest_ms = std::chrono::duration<double, std::milli>(until - Clock::now()).count();
    pollfd waiting{socket_, POLLIN, 0};
    return ::poll(&waiting, 1, static_cast<int>(std::ceil(std::clamp(rest_ms, 0.0, 1000.0)))) > 0;
  }
  /// Takes what has come, and keeps the newest few. Returns how many there were.
  std::size_t take() {
    std::size_t taken = 0;
    for (int i = 0; i < most_taken; ++i) {
      const ssize_t size = ::recv(socket_, buffer_.data(), buffer_.size(), 0);
      if (size < 0) break;  // no more, or an error that the next datagram does not have
      newest_[taken++ % most_read].assign(buffer_, 0, static_cast<std::size_t>(size));
    }
    return taken;
  }
  bool read(const std::string& datagram, TrackedFrame& out) {
    try {
      std::optional<TrackedFrame> frame = read_frame(datagram, its_name);
      if (!frame) return false;
      if (last_s_ && frame->time_s <= *last_s_ && frame->time_s >= *last_s_ - longest_delay_s) {
        left_out_.add("a frame that is not newer than the one before");
        return false;
      }
      last_s_ = frame->time_s;
      out = *std::move(frame);
      return true;
    } catch (const Error& error) {
      left_out_.add("a datagram that is no frame", error.what());
      return false;
    }
  }

  std::string source_;
  LeftOut left_out_{source_};
  int socket_;
  std::string buffer_;
  std::array<std::string, most_read> newest_;  ///< a ring
  HandCheck check_;
  std::optional<double> last_s_;
  std::uint64_t number_ = 0, replaced_ = 0;
};

}  // namespace

std::unique_ptr<Tracker> open_udp_tracker(const std::string& address) {
  return std::make_unique<UdpTracker>(address);
}

}  // namespace palpa::sensing
