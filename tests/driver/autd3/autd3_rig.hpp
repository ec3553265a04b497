// Emulated AUTD3 units behind a server, and a board on it as its guard has it.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/system/now.hpp"
#include "driver/autd3/board.hpp"
#include "driver/autd3/emulated/listener.hpp"
#include "driver/autd3/emulated/server.hpp"
#include "driver/autd3/wire.hpp"
#include "driver/rig_parts.hpp"

namespace palpa::test {

/// An emulated server that runs as long as this object lives.
class Autd3Serving {
 public:
  /// `late` is the delay of every request.
  explicit Autd3Serving(driver::autd3::EmulatedServer& server, std::uint16_t port = 0,
                        std::chrono::milliseconds late = {})
      : Autd3Serving(server, port, [late](auto) { std::this_thread::sleep_for(late); }) {}
  /// `before` is called with the bytes of each request, before the server takes them.
  Autd3Serving(driver::autd3::EmulatedServer& server, std::uint16_t port,
               const std::function<void(std::span<const std::uint8_t>)>& before)
      : listener_(port) {
    thread_ = std::thread([this, &server, before] { listener_.serve(server, stop_, lock, before); });
  }
  ~Autd3Serving() {
    stop_ = true;
    thread_.join();
  }
  Autd3Serving(const Autd3Serving&) = delete;
  Autd3Serving& operator=(const Autd3Serving&) = delete;
  std::string address() const { return listener_.address(); }
  std::uint16_t port() const { return listener_.port(); }
  std::mutex lock;

 private:
  driver::autd3::Listener listener_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A board on it, as its guard has it.
struct Autd3Rig {
  array::Layout layout;
  driver::autd3::EmulatedServer server;
  std::unique_ptr<Autd3Serving> serving;
  std::string argument, files;
  KeptNotes notes;
  std::unique_ptr<driver::Board> board;
  array::Drive drives, silence;
  std::vector<Vec3> foci;
  std::uint64_t slot = 1000;
  double sound_speed_m_s = 340;

  explicit Autd3Rig(const std::string& name = "autd3")
      : layout(array::load_layout(name)),
        server(layout.boards.size()),
        serving(std::make_unique<Autd3Serving>(server)) {
    argument = serving->address();
    drives.resize(10 * layout.transducers.size());
    for (std::size_t i = 0; i < drives.size(); ++i)
      drives[i] = {static_cast<float>(i % 97 + 1) / 97, static_cast<float>(static_cast<double>(i % 61) / 10 - 3)};
    silence.assign(layout.transducers.size(), {0.0f, 0.0f});
  }
  std::unique_ptr<driver::Board> make(double slot_s = 1.5e-3) {
    return driver::autd3::board_kind().open(
        {.argument = argument, .files = files, .layout = layout, .slot_s = slot_s, .sound_speed_m_s = sound_speed_m_s},
        notes);
  }
  void open() { board = make(); }
  std::span<const array::TransducerDrive> part(std::uint64_t s) const {
    return std::span(drives).subspan((s % 10) * silence.size(), silence.size());
  }
  /// The time at which the plan's first slot begins, in the devices' time.
  double plan(double hz = 0) {
    double from_s = monotonic_s(), device_s = driver::autd3::device_time_s();
    while (monotonic_s() > from_s + 20e-6) {  // both at the same time
      from_s = monotonic_s();
      device_s = driver::autd3::device_time_s();
    }
    const session::Cycle cycle{.plays = session::Plays::pattern,
                               .length = 10,
                               .modulation_hz = hz,
                               .modulation = array::Modulation::amplitude_sine};
    board->plan({{{slot, slot + 1000000, cycle}, from_s, 1.5e-3}, drives, foci});
    return device_s;
  }
  /// As a guard does between drives.
  template <typename Done>
  bool tend_until(const Done& done, std::chrono::milliseconds at_most = std::chrono::minutes(1)) {
    for (const auto end = std::chrono::steady_clock::now() + at_most; std::chrono::steady_clock::now() < end;) {
      board->tend();
      {
        const std::lock_guard held(serving->lock);
        if (done()) return true;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return false;
  }
  void tend_for(std::chrono::milliseconds time) {
    tend_until([] { return false; }, time);
  }
  bool silent() const { return server.silent(driver::autd3::device_time_s()); }
  bool falls_silent() {
    return tend_until([&] { return silent(); });
  }
  bool sounds() {
    return tend_until([&] { return !silent(); });
  }
  const driver::autd3::EmulatedDevice& device() const { return server.devices()[0]; }
  /// Turns everything off, and ends.
  void end_silent() {
    board->all_off();
    EXPECT_TRUE(board->close());
    EXPECT_TRUE(silent());
    EXPECT_EQ(server.violation_count(), 0u) << server.violations()[0].what;
  }
};

/// Each device emits one whole part of the pattern.
inline int part_heard(const Autd3Rig& rig, double at_s) {
  for (std::uint64_t p = 0; p < 10; ++p) {
    bool all = true;
    for (std::size_t d = 0; d < rig.server.devices().size() && all; ++d) {
      const auto heard = rig.server.devices()[d].output(at_s);
      for (std::size_t t = 0; t < driver::autd3::transducers && all; ++t) {
        const driver::autd3::Emission e = driver::autd3::emission(rig.part(p)[d * driver::autd3::transducers + t]);
        all = heard[t].phase == e.phase && heard[t].intensity == e.intensity;
      }
    }
    if (all) return static_cast<int>(p);
  }
  return -1;
}

}  // namespace palpa::test
