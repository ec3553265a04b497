// Emulated AUTD3 units behind a server, on TCP in real time or on a socket in a test's own time; and a board on it as
// its guard has it.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/system/descriptor.hpp"
#include "driver/autd3/board.hpp"
#include "driver/autd3/emulated/listener.hpp"
#include "driver/autd3/emulated/server.hpp"
#include "driver/autd3/pattern.hpp"
#include "driver/autd3/remote.hpp"
#include "driver/autd3/wire.hpp"
#include "driver/rig_parts.hpp"
#include "driver/served_clock.hpp"

namespace palpa::test {

/// An emulated server on TCP that runs as long as this object lives.
class Autd3Serving {
 public:
  explicit Autd3Serving(driver::autd3::EmulatedServer& server)
      : listener_(0), thread_([this, &server] { listener_.serve(server, stop_, lock); }) {}
  ~Autd3Serving() {
    stop_ = true;
    thread_.join();
  }
  Autd3Serving(const Autd3Serving&) = delete;
  Autd3Serving& operator=(const Autd3Serving&) = delete;
  std::string address() const { return listener_.address(); }
  std::mutex lock;

 private:
  driver::autd3::Listener listener_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// An emulated server on a socket of this process, which answers while a clock passes.
class SteppedAutd3Server {
 public:
  explicit SteppedAutd3Server(std::size_t devices) : server(devices) { listen(); }

  driver::autd3::EmulatedServer server;
  double late_s = 0;                ///< the delay of every request
  bool hangs = false;               ///< it takes nothing
  bool bus_closed = false;          ///< it does not answer the geometry yet
  std::optional<std::size_t> slow;  ///< this device has not acknowledged the last message yet
  /// What it answers to the first request, whatever that is; then it hangs or closes the connection.
  std::optional<std::string> lies;
  bool stays = true;

  /// It can be reached by anyone who comes.
  void listen() {
    listener_ = Descriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (address_.places.empty()) {
      sockaddr_un name{};
      name.sun_family = AF_UNIX;
      socklen_t size = sizeof name.sun_family;  // the system chooses a name
      EXPECT_EQ(bind(listener_.get(), reinterpret_cast<const sockaddr*>(&name), size), 0);
      driver::autd3::Address::Place& place = address_.places.emplace_back();
      place.size = sizeof place.where;
      getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&place.where), &place.size);
      address_.text = "server:8080";
    } else {
      const auto& place = address_.places[0];
      EXPECT_EQ(bind(listener_.get(), reinterpret_cast<const sockaddr*>(&place.where), place.size), 0);
    }
    EXPECT_EQ(::listen(listener_.get(), 1), 0);
  }
  /// It is gone, and its devices continue to sound.
  void end() {
    listener_ = Descriptor();
    client_ = Descriptor();
    came_.clear();
  }
  const driver::autd3::Address& address() const { return address_; }

  /// Does what can be done at that time; `device_s` is the same in the devices' time.
  void serve(double now_s, double device_s) {
    if (hangs || !listener_) return;
    if (!client_) {
      client_ = Descriptor(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (!client_) return;
      server.client_came();
    }
    std::array<std::uint8_t, 65536> bytes{};
    const ssize_t size = recv(client_.get(), bytes.data(), bytes.size(), 0);
    if (size == 0 || (size < 0 && errno != EAGAIN)) return leave(device_s);
    if (size > 0) {
      came_.insert(came_.end(), bytes.begin(), bytes.begin() + size);
      due_s_ = now_s + late_s;
    }
    constexpr std::uint8_t geometry = 0x01;
    if (came_.empty() || now_s < due_s_ || (bus_closed && came_[0] == geometry)) return;
    if (lies) {
      send(client_.get(), lies->data(), lies->size(), MSG_NOSIGNAL);
      hangs = stays;
      if (!stays) end();
      return;
    }
    std::vector<std::uint8_t> answer;
    constexpr std::uint8_t read = 0x04;
    const bool asks = came_[0] == read;
    const bool goes_on = server.take(device_s, came_, answer);
    if (asks && slow) answer.at(2 + 2 * *slow) ^= 1;
    came_.clear();
    send(client_.get(), answer.data(), answer.size(), MSG_NOSIGNAL);
    if (!goes_on) leave(device_s);
  }

 private:
  void leave(double device_s) {
    client_ = Descriptor();
    came_.clear();
    server.client_left(device_s);
  }

  driver::autd3::Address address_;
  Descriptor listener_, client_;
  std::vector<std::uint8_t> came_;
  double due_s_ = 0;
};

/// A board on it, as its guard has it, in a time that passes only while somebody waits.
struct Autd3Rig {
  array::Layout layout;
  SteppedAutd3Server serving;
  driver::autd3::EmulatedServer& server = serving.server;
  ServedClock clock{[this] { serving.serve(clock.now_s(), device_now_s()); }};
  KeptNotes notes;
  std::unique_ptr<driver::Board> board;
  array::Drive drives, silence;
  std::vector<Vec3> foci;
  std::uint64_t slot = 1000;
  double sound_speed_m_s = 340;
  bool nulls = false;

  explicit Autd3Rig(const std::string& name = "autd3")
      : layout(array::load_layout(name)), serving(layout.boards.size()) {
    drives.resize(10 * layout.transducers.size());
    for (std::size_t i = 0; i < drives.size(); ++i)
      drives[i] = {static_cast<float>(i % 97 + 1) / 97, static_cast<float>(static_cast<double>(i % 61) / 10 - 3)};
    silence.assign(layout.transducers.size(), {0.0f, 0.0f});
  }
  Autd3Rig(const Autd3Rig&) = delete;
  Autd3Rig& operator=(const Autd3Rig&) = delete;

  double device_now_s() const { return clock.now_s() + clock.day_at_zero_s() - driver::autd3::epoch_s; }
  std::unique_ptr<driver::Board> make(double slot_s = 1.5e-3) {
    return driver::autd3::open_board(
        {.layout = layout, .slot_s = slot_s, .sound_speed_m_s = sound_speed_m_s, .nulls = nulls}, notes,
        serving.address(), clock);
  }
  void open() { board = make(); }
  std::span<const array::TransducerDrive> part(std::uint64_t s) const {
    return std::span(drives).subspan((s % 10) * silence.size(), silence.size());
  }
  /// The time at which the plan's first slot begins, in the devices' time.
  double plan(double hz = 0) {
    const double device_s = device_now_s();
    const session::Cycle cycle{.plays = session::Plays::pattern,
                               .length = 10,
                               .modulation_hz = hz,
                               .modulation = array::Modulation::amplitude_sine};
    board->plan({{{slot, slot + 1000000, cycle}, clock.now_s(), 1.5e-3}, drives, foci});
    return device_s;
  }
  /// As a guard does between drives.
  template <typename Done>
  bool tend_until(const Done& done) {
    return clock.passes_until([&] {
      board->tend();
      return done();
    });
  }
  void tend_for(double seconds) {
    tend_until([&, end_s = clock.now_s() + seconds] { return clock.now_s() >= end_s; });
  }
  bool silent() const { return server.silent(device_now_s()); }
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
