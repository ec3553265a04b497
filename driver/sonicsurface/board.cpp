#include "driver/sonicsurface/board.hpp"

#include <fmt/core.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "array/layouts/board_types.hpp"
#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/system/descriptor.hpp"
#include "driver/guard/channel.hpp"
#include "driver/lag.hpp"
#include "driver/plan_tally.hpp"
#include "driver/sonicsurface/line.hpp"
#include "driver/sonicsurface/wire.hpp"
#include "session/links/slots.hpp"

namespace palpa::driver::sonicsurface {
namespace {

constexpr double retry_s = 1, close_patience_s = 0.5;
/// A line that is this much slower than its speed takes nothing any more.
constexpr double late_s = 30e-3;

struct Port {
  std::string path;
  Firmware firmware = Firmware::plain;
  std::optional<double> lag{};  ///< of the secondary board, in periods, if it was given
};

Port parse_port(std::string argument) {
  const std::string tactile = ",tactile";
  Port port;
  if (argument.find(tactile) != std::string::npos && argument.find(",lag=") != std::string::npos) {
    throw bad_usage(
        "link sonicsurface takes tactile or lag=, not both: with the tactile firmware there is one board, and lag= is "
        "for the second of two");
  }
  port.lag = take_lag(argument);
  if (argument.ends_with(tactile)) {
    argument.resize(argument.size() - tactile.size());
    port.firmware = Firmware::tactile;
  }
  if (argument.empty() || argument.find(',') != std::string::npos) {
    throw bad_usage(
        "link sonicsurface takes PORT, PORT,tactile or PORT,lag=PERIODS, such as sonicsurface:/dev/ttyUSB0, not '" +
        argument + "'");
  }
  port.path = argument;
  return port;
}

std::size_t boards_of(const array::Layout& layout, const Port& port) {
  const std::size_t most = port.firmware == Firmware::plain ? 2 : 1;
  const std::size_t boards = boards_of_type(layout, "sonicsurface", transducers);
  if (boards == 0 || boards > most) {
    throw bad_input("layout " + layout.name,
                    fmt::format("link sonicsurface drives {} of type sonicsurface, and nothing else",
                                most == 2 ? "one or two boards" : "one board (tactile firmware)"));
  }
  refuse_lag_of_one(port.lag, boards);
  return boards;
}

void check_pace(const BoardSpec& spec, std::size_t boards) {
  const double frame_s = array::find_board_type("sonicsurface")->moving_slot_s(boards);
  if (!spec.foci_move || spec.slot_s >= frame_s) return;
  throw bad_usage(
      fmt::format("link sonicsurface: a frame takes {:.1f} ms, so a slot of {:g} ms is too short; use --dwell {:g}ms, "
                  "or a focus that does not move, such as --method single-focus of palpa run",
                  1e3 * frame_s, 1e3 * spec.slot_s, std::ceil(1e3 * frame_s)));
}

class SonicSurface final : public Board {
 public:
  /// `notes` and `clock` must outlive this object.
  SonicSurface(const BoardSpec& spec, BoardNotes& notes, Clock& clock, const Port& port, std::size_t boards)
      : notes_(notes),
        clock_(clock),
        encoder_(boards, port.firmware, read_degrees(spec.files, boards * transducers),
                 port.lag.value_or(array::find_board_type("sonicsurface")->follower_lag)),
        line_(port.path),
        timer_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)),
        still_(encoder_.size()),
        newest_(encoder_.size()),
        loaded_(encoder_.size()),
        all_off_(encoder_.all_off()),
        own_off_(encoder_.own_off()),
        own_are_all_(port.firmware != Firmware::plain || boards == 2) {
    out_.reserve(own_off_.size() + all_off_.size());
    fall_silent(all_off_);
    pump();
  }

  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    const bool still = has_still_ && slot < until_slot_;
    if (!session::sounds(drive)) {
      silence();
    } else if (still) {
      sounding_ = true;
      tally_.allow(start_drives());
      pump();
      if (!stuck()) tally_.play();
      return;
    } else {
      encoder_.encode(drive, newest_);
      sounding_ = drive_waits_ = true;
    }
    pump();
  }

  void plan(const BoardPlan& plan) override {
    const session::Cycle& cycle = plan.slots.cycle;
    has_still_ = cycle.length == 1;
    if (cycle.plays == session::Plays::nothing) silence();
    if (!has_still_) return;
    encoder_.encode(plan.drives, still_);
    until_slot_ = plan.slots.until;
    slot_s_ = plan.slot_s;
    hz_ = cycle.modulation_hz;
    tally_.allow(start_drives());
    sounding_ = true;
    drive_waits_ = false;
    pump();
  }

  /// A second board behind a single one is silenced when the port is opened. If it is switched on after that, it
  /// sounds.
  void all_off() override {
    sounding_ = drive_waits_ = false;
    if (!silent_) {
      fall_silent(all_off_);
    } else if (!all_silent_) {
      say_more(all_off_);
      all_silent_ = true;
    }
    pump();
  }

  void tend() override {
    std::uint64_t expirations = 0;
    [[maybe_unused]] const ssize_t read_now = read(timer_.get(), &expirations, sizeof expirations);
    pump();
  }

  std::span<const pollfd> watched() override {
    watched_[0] = {timer_.get(), POLLIN, 0};
    watched_[1] = {line_.fd(), POLLOUT, 0};
    return std::span(watched_).first(sent_ < out_.size() && !line_.gone() ? 2 : 1);
  }

  bool close() override {
    const double until_s = clock_.now_s() + close_patience_s;
    retry_at_s_ = 0;
    while (!silent_ || sent_ < out_.size() || !line_.drained() || clock_.now_s() < line_free_s_) {
      if (clock_.now_s() >= until_s) return false;
      clock_.sleep_s(1e-3);
      pump();
    }
    return true;
  }

  BoardCounts counts() const override { return tally_.counts(lost_); }

 private:
  /// How many drives may pass until a first pattern is there: the time to silence both buffers and send a frame, and
  /// the same again for what the line still has.
  std::uint64_t start_drives() const {
    const double start_s = 2 * seconds_of(all_off_.size() + encoder_.size());
    return slot_s_ > 0 ? static_cast<std::uint64_t>(std::ceil(start_s / slot_s_)) : 0;
  }

  void silence() {
    sounding_ = drive_waits_ = false;
    if (!silent_) fall_silent(own_off_);
  }

  /// Drops what waits, in the kernel, too. Then sends all off for both buffers.
  void fall_silent(std::span<const std::uint8_t> off) {
    tally_.gone();
    on_its_way_ = Load::none;
    line_.drop();
    line_free_s_ = clock_.now_s();
    say(off);
    silent_ = true;
    all_silent_ = own_are_all_ || off.size() == all_off_.size();
    loaded_hz_ = 0;
    front_off_ = back_off_ = true;
    std::fill(loaded_.begin(), loaded_.end(), std::uint8_t{0});
  }

  void say(std::span<const std::uint8_t> bytes) {
    out_.assign(bytes.begin(), bytes.end());
    sent_ = 0;
    line_free_s_ = std::max(line_free_s_, clock_.now_s()) + seconds_of(bytes.size());
  }
  /// Queues bytes behind a silence that is on its way, because starting that again would only delay it.
  void say_more(std::span<const std::uint8_t> bytes) {
    out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(sent_));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
    sent_ = 0;
    line_free_s_ = std::max(line_free_s_, clock_.now_s()) + seconds_of(bytes.size());
  }

  /// Continues until the line is busy or there is nothing to do. Sets the timer for what comes next.
  void pump() {
    while (true) {
      const double now_s = clock_.now_s();
      if (line_.gone() && !come_back(now_s)) return;
      if (sent_ < out_.size()) {
        sent_ += line_.write(std::span(out_).subspan(sent_));
        if (line_.gone()) return lose(now_s);
        if (sent_ < out_.size()) return;
      }
      if (now_s >= line_free_s_ && line_.drained()) has_arrived();
      if (!sounding_) return;
      if (now_s < line_free_s_) return wake_at(line_free_s_);
      if (!next(now_s)) return;
    }
  }

  /// Returns false if there is nothing to send now.
  bool next(double now_s) {
    if (drive_waits_) {
      drive_waits_ = false;
      load(newest_, now_s, Load::drive);
      return true;
    }
    if (!has_still_) return false;
    const bool differs = loaded_ != still_ || loaded_hz_ != hz_;
    if (hz_ == 0) {
      if (differs) load(still_, now_s, Load::plan);
      return differs;
    }
    if (!front_off_ && !back_off_) {  // there was no modulation before
      fall_silent(own_off_);
      return true;
    }
    // Only behind a silent front buffer can a pattern be written without being heard half-written. It is heard when it
    // is there: if the pauses are long enough for it, it comes at the end of one.
    const double frame_s = seconds_of(still_.size());
    const bool fits = 0.5 / hz_ > frame_s;
    const double begin_s = fits ? toggle_s_ - frame_s : now_s;
    const bool in_time = now_s >= begin_s && now_s < begin_s + frame_s / 4;
    if (differs && front_off_ && (silent_ || (in_time && now_s >= loaded_s_ + refresh_s))) {
      load(still_, now_s, Load::plan);
      toggle_s_ = line_free_s_ + 0.5 / hz_;
      return true;
    }
    if (now_s < toggle_s_) {
      wake_at(differs && front_off_ && now_s < begin_s ? begin_s : toggle_s_);
      return false;
    }
    std::swap(front_off_, back_off_);
    say(swap_byte_);
    toggle_s_ += 0.5 / hz_;
    if (toggle_s_ < now_s) toggle_s_ = now_s + 0.5 / hz_;  // late: skip, so that there is no burst
    return true;
  }

  enum class Load { none, drive, plan };
  void load(const std::vector<std::uint8_t>& frame, double now_s, Load what) {
    say(frame);
    on_its_way_ = what;
    what == Load::plan ? tally_.sent() : tally_.drive_sent();
    loaded_ = frame;
    loaded_hz_ = hz_;
    loaded_s_ = now_s;
    back_off_ = front_off_;
    front_off_ = false;
    silent_ = all_silent_ = false;
  }

  /// Whether bytes that should have left are still in this computer. More than that a serial port cannot know: its
  /// board never answers.
  bool stuck() const { return clock_.now_s() > line_free_s_ + late_s && (sent_ < out_.size() || !line_.drained()); }

  /// Called when the loaded data has left, according to the line's speed and to the kernel.
  void has_arrived() {
    const Load what = std::exchange(on_its_way_, Load::none);
    if (what == Load::plan) tally_.there();
    if (what == Load::drive) tally_.drive_there();
  }

  void wake_at(double when_s) const {
    itimerspec when{};
    when.it_value.tv_sec = static_cast<time_t>(when_s);
    when.it_value.tv_nsec = static_cast<long>(1e9 * (when_s - std::floor(when_s)));
    timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &when, nullptr);
  }

  void lose(double now_s) {
    out_.clear();
    sent_ = 0;
    silent_ = all_silent_ = false;
    tally_.lost();
    on_its_way_ = Load::none;
    retry_at_s_ = now_s + retry_s;
    if (!std::exchange(lost_, true)) notes_.warning("the serial port is gone");
  }

  /// Silence comes before anything else.
  bool come_back(double now_s) {
    if (now_s < retry_at_s_) return false;
    retry_at_s_ = now_s + retry_s;
    if (!line_.reopen()) return false;
    lost_ = false;
    fall_silent(all_off_);
    notes_.warning("the serial port is back");
    return true;
  }

  static constexpr std::array<std::uint8_t, 1> swap_byte_{swap};

  BoardNotes& notes_;
  Clock& clock_;
  Encoder encoder_;
  Line line_;
  Descriptor timer_;
  std::array<pollfd, 2> watched_{};

  // What should sound.
  bool sounding_ = false;
  bool has_still_ = false;            ///< there is a plan of one drive
  std::vector<std::uint8_t> still_;   ///< as a frame
  std::vector<std::uint8_t> newest_;  ///< the newest drive that no such plan has
  bool drive_waits_ = false;
  std::uint64_t until_slot_ = 0;
  double slot_s_ = 0, hz_ = 0;

  // What the boards do.
  std::vector<std::uint8_t> loaded_;
  double loaded_hz_ = 0, loaded_s_ = 0, toggle_s_ = 0;
  bool front_off_ = true, back_off_ = true;  ///< states of the buffers
  bool silent_ = false;                      ///< all off has been sent, and nothing since
  bool all_silent_ = false;                  ///< to every board that may be there
  std::vector<std::uint8_t> all_off_, own_off_, out_;
  bool own_are_all_;  ///< there can be no board but the layout's
  std::size_t sent_ = 0;
  double line_free_s_ = 0;  ///< when everything sent has left, according to the line's speed
  bool lost_ = false;
  double retry_at_s_ = 0;
  PlanTally tally_;
  Load on_its_way_ = Load::none;
};

}  // namespace

std::vector<float> read_degrees(const std::string& folder, std::size_t count) {
  if (folder.empty()) return {};
  const std::string file = (std::filesystem::path(folder) / "sonicsurface.txt").string();
  constexpr std::uint64_t most_bytes = 1 << 20;
  std::string bytes;
  try {
    bytes = read_file(file, most_bytes);
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    throw bad_input(file,
                    fmt::format("cannot be read; it must have {} numbers, one per transducer, in degrees", count));
  }
  std::istringstream in{std::string(text_in(bytes, file))};
  std::vector<float> degrees;
  for (float value = 0; in >> value;) {
    if (!(std::abs(value) <= 360)) {
      // If no phase came before, it may be any file, and nothing of it must be shown.
      const std::string what = degrees.empty() ? "its first number is" : fmt::format("{} degrees is", value);
      throw bad_input(file, what + " not a phase from -360 to 360");
    }
    degrees.push_back(value);
  }
  if (!in.eof()) throw bad_input(file, fmt::format("value {} is not a number", degrees.size() + 1));
  if (degrees.size() != count)
    throw bad_input(file, fmt::format("has {} numbers, but the boards have {} transducers", degrees.size(), count));
  return degrees;
}

std::unique_ptr<Board> open_board(const BoardSpec& spec, BoardNotes& notes, Clock& clock) {
  const Port port = parse_port(spec.argument);
  const std::size_t boards = boards_of(spec.layout, port);
  check_pace(spec, boards);
  return std::make_unique<SonicSurface>(spec, notes, clock, port, boards);
}

BoardKind board_kind() {
  return {"sonicsurface",
          "sonicsurface:PORT[,tactile|,lag=PERIODS]: SonicSurface boards on a serial port",
          [](const BoardSpec& spec, BoardNotes& notes) { return open_board(spec, notes, steady_clock()); },
          true,
          true,
          [](const std::string&) { return std::string("sonicsurface"); },
          [](const std::string& argument, const array::Layout& layout) {
            return array::find_board_type("sonicsurface")->moving_slot_s(boards_of(layout, parse_port(argument)));
          }};
}

}  // namespace palpa::driver::sonicsurface
