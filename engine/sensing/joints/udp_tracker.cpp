// Frames that a tracker's program sends to a port of this computer, one in each datagram. The newest frame wins.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/udp.hpp"
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
/// Before the first frame, all that waited while palpa started, so that only that frame is old.
constexpr int most_waiting = 4096;
constexpr std::size_t most_read = 4;
/// This many frames in a row that are not newer, and ascend, come from a clock that was set back.
constexpr int most_older = 3;
const std::string its_name = "the datagram";

class UdpTracker final : public Tracker {
 public:
  explicit UdpTracker(const std::string& address)
      : source_("joints:udp:" + address),
        socket_(parse_listening_address(address, form), source_),
        buffer_(most_datagram, 0) {}
  ~UdpTracker() override {
    if (replaced_ > 0) log::info(fmt::format("{}: {} datagrams were left out for newer ones", source_, replaced_));
  }
  UdpTracker(const UdpTracker&) = delete;
  UdpTracker& operator=(const UdpTracker&) = delete;

  bool next(TrackedFrame& out, bool& came, std::uint64_t& number, double timeout_s) override {
    const std::chrono::duration<double> timeout(std::max(timeout_s, 0.0));
    const Clock::time_point until = Clock::now() + std::chrono::duration_cast<Clock::duration>(timeout);
    came = false;
    do {
      if (!socket_.wait(std::chrono::duration<double>(until - Clock::now()).count())) break;
      const std::size_t taken = take();
      for (std::size_t i = 0; i < std::min(taken, most_read) && !came; ++i)
        came = read(newest_[(taken - 1 - i) % most_read], out);
      if (came) number_ += taken;
      if (taken > 0) replaced_ += taken - 1;
    } while (!came && Clock::now() < until);
    if (!came) return true;
    number = number_ - 1;
    const double arrived_s = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
    if (const auto doubt = check_.check(out, arrived_s)) left_out_.add(to_text(*doubt));
    return true;
  }

 private:
  /// Takes what has come, and keeps the newest few. Returns how many there were.
  std::size_t take() {
    std::size_t taken = 0;
    for (int i = 0; i < (number_ == 0 ? most_waiting : most_taken); ++i) {
      const std::optional<std::size_t> size = socket_.receive(buffer_);
      if (!size) break;
      newest_[taken++ % most_read].assign(buffer_, 0, *size);
    }
    return taken;
  }
  /// A frame that is older by more was sent by a tracker that was started again.
  bool is_late(double time_s) {
    if (!last_s_ || time_s > *last_s_ || time_s < *last_s_ - longest_delay_s) return false;
    if (older_ == 0 || time_s > older_s_) {
      ++older_;
      older_s_ = time_s;
    }
    return older_ < most_older;
  }
  bool read(const std::string& datagram, TrackedFrame& out) {
    try {
      std::optional<TrackedFrame> frame = read_frame(datagram, its_name);
      if (!frame) return false;
      if (is_late(frame->time_s)) {
        left_out_.add("a frame that is not newer than the one before");
        return false;
      }
      last_s_ = frame->time_s;
      older_ = 0;
      out = *std::move(frame);
      return true;
    } catch (const Error& error) {
      left_out_.add("a datagram that is no frame", error.what());
      return false;
    }
  }

  std::string source_;
  LeftOut left_out_{source_};
  UdpReceiver socket_;
  std::string buffer_;
  std::array<std::string, most_read> newest_;  ///< a ring
  HandCheck check_;
  std::optional<double> last_s_;
  int older_ = 0;  ///< ascending frames in a row that were not newer, and the time of the last of them
  double older_s_ = 0;
  std::uint64_t number_ = 0, replaced_ = 0;
};

}  // namespace

std::unique_ptr<Tracker> open_udp_tracker(const std::string& address) {
  return std::make_unique<UdpTracker>(address);
}

}  // namespace palpa::sensing
