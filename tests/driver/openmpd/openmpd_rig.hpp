// Emulated OpenMPD boards on a bus of this process, in a time that advances only when a test lets it.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "driver/board.hpp"
#include "driver/clock.hpp"
#include "driver/openmpd/board.hpp"
#include "driver/openmpd/emulated/board.hpp"
#include "driver/rig_parts.hpp"
#include "driver/usb/in_process.hpp"

namespace palpa::test {

class TestClock final : public driver::Clock {
 public:
  double now_s() const override { return now_s_; }
  void sleep_s(double seconds) override {
    now_s_ += seconds;
    if (now_s_ >= then_s_) std::exchange(then_, [] {})();
  }
  /// Calls `then` once, at that time.
  void at(double then_s, std::function<void()> then) {
    then_s_ = then_s;
    then_ = std::move(then);
  }

 private:
  double then_s_ = std::numeric_limits<double>::infinity();
  std::function<void()> then_ = [] {};
  double now_s_ = 3;  // boards have been on for a while
};

/// `serials.size()` boards, 1 or 2 unless a layout is given.
struct OpenMpdRig {
  explicit OpenMpdRig(std::vector<std::string> serials = {"EMU1"},
                      driver::usb::ftdi::Channel channel = driver::usb::ftdi::Channel::fifo)
      : layout(array::load_layout(serials.size() == 1 ? "openmpd" : "openmpd-pair")) {
    for (const std::string& serial : serials) {
      argument += (argument.empty() ? "" : ",") + serial;
      emulators.push_back(std::make_unique<driver::openmpd::EmulatedBoard>(serial, channel));
      faults.push_back(&bus.plug(*emulators.back()));
    }
  }

  /// Takes sixteen boards in their place, on so many buses.
  void take_sixteen(unsigned buses = 1) {
    layout.boards.clear();
    layout.transducers.resize(std::size_t{16} * 256);
    argument.clear();
    for (unsigned i = 0; i < 16; ++i) {
      const std::string serial = "B" + std::to_string(i);
      argument += (i == 0 ? "" : ",") + serial;
      emulators.push_back(std::make_unique<driver::openmpd::EmulatedBoard>(serial));
      faults.push_back(&bus.plug(*emulators.back(), 1 + i % buses));
      layout.boards.push_back({"openmpd", 256 * i, 256, 0.168, 0.168});
    }
  }
  driver::openmpd::Fpga& fpga(std::size_t i) { return emulators[i]->fpga(); }

  void open() { open(bus); }
  void open(driver::usb::Transport& transport) {
    board = std::make_unique<driver::openmpd::OpenMpdBoard>(driver::BoardSpec{.argument = argument,
                                                                              .files = files,
                                                                              .layout = layout,
                                                                              .slot_s = slot_s,
                                                                              .ramp_s = ramp_s,
                                                                              .steps = steps,
                                                                              .nulls = nulls},
                                                            notes, transport, clock);
  }
  /// Plays one slot after the other, like a guard.
  void play(const array::Drive& drive, double seconds) {
    for (const double end_s = clock.now_s() + seconds; clock.now_s() < end_s - 1e-9;) {
      board->play(slot++, drive);
      // With steps, a guard also wakes up when a transfer has ended.
      const int tends = steps ? 10 : 2;
      for (int i = 1; i < tends; ++i) {
        clock.sleep_s(slot_s / tends);
        board->tend();
      }
      clock.sleep_s(slot_s / tends);
    }
    look();
  }
  /// Brings the boards' own time up to date.
  void look() {
    for (auto& emulator : emulators)
      emulator->advance(clock.now_s());
  }
  bool sounds() const {
    bool any = false;
    for (const auto& emulator : emulators)
      any = any || emulator->fpga().sounds();
    return any;
  }
  /// Whether nothing sounds that much later.
  bool silent_after(double seconds) {
    clock.sleep_s(seconds);
    look();
    return !sounds();
  }
  /// What a guard does while it gets no drives.
  void tend_for(double seconds) {
    for (const double end_s = clock.now_s() + seconds; clock.now_s() < end_s - 1e-9; board->tend())
      clock.sleep_s(5e-3);
    look();
  }
  std::string violations() const {
    std::string text;
    for (const auto& emulator : emulators) {
      for (const auto& violation : emulator->violations().kept())
        text += std::to_string(violation.time_s) + " s: " + violation.what + "\n";
    }
    return text;
  }

  TestClock clock;
  driver::usb::InProcessBus bus{clock};
  array::Layout layout;
  std::string argument, files;
  double slot_s = 1.5e-3, ramp_s = 0;
  bool steps = false, nulls = false;
  KeptNotes notes;
  std::vector<std::unique_ptr<driver::openmpd::EmulatedBoard>> emulators;
  std::vector<driver::usb::Faults*> faults;
  std::unique_ptr<driver::openmpd::OpenMpdBoard> board;
  std::uint64_t slot = 0;
};

/// A focus above the first board.
inline array::Drive focus_drive(const array::Layout& layout, const Vec3& focus = {0.01, -0.005, 0.15},
                                array::Weighting weighting = array::Weighting::distance) {
  const array::SlotFocus foci[]{{focus}};
  array::DriveOptions options;
  options.weighting = weighting;
  return array::drive_for(layout, foci, options);
}

}  // namespace palpa::test
