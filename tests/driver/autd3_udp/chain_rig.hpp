// A chain of made-up AUTD3 units of the UDP line, in a test's own time, for the client alone: they do what a test
// needs, and lose, repeat or delay datagrams when told to. What they understand was written for this test, from the
// bytes.
#pragma once

#include <gtest/gtest.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/system/descriptor.hpp"
#include "driver/autd3_udp/board.hpp"
#include "driver/autd3_udp/cable.hpp"
#include "driver/rig_parts.hpp"
#include "driver/served_clock.hpp"

namespace palpa::test {

using driver::autd3_udp::Endpoint;
using Bytes = std::vector<std::uint8_t>;

inline Endpoint unit_address(int last) {
  Endpoint out{.scope = 7, .port = 44336};
  out.address = {0xfe, 0x80, 0, 0, 0, 0, 0, 0, 0, 0x41, 0x55, 0xff, 0xfe, 0x54, 0x44, static_cast<std::uint8_t>(last)};
  return out;
}

struct MadeUpUnit {
  using Pattern = std::vector<std::pair<int, int>>;  ///< phase and intensity
  int protocol = 5;
  int minor = 13;  ///< of its firmware
  // Its state.
  int id = 0xff;
  bool far_open = false, first = false, locked = false, pulse = true, shut = false;
  int ack = 0, last_command = -1;
  int failsafe_ms = 0;
  double heard_s = -1, failsafe_off_until_s = 0;
  std::map<int, Pattern> banks[2];
  int bank = 0, size[2] = {1, 1}, divider[2] = {65535, 65535};
  bool foci[2] = {false, false};
  Bytes modulation[2];
  int modulation_bank = 0, modulation_divider[2] = {65535, 65535};
  struct Waiting {
    double at_s;
    Bytes bytes;
    Endpoint from;
  };
  std::deque<Waiting> queue;
  // What a test looks at.
  std::vector<Bytes> frames;    ///< as they came
  std::vector<int> commands;    ///< that were carried out
  std::vector<double> shown_s;  ///< when a pattern began to sound
  std::vector<Pattern> shown;   ///< ... which
  bool mute = false;            ///< it hears nothing
  int lose = 0, lose_answers = 0, repeat = 0;
  int queue_full = 0;  ///< it drops so many frames

  bool counts() const { return protocol != 5; }
  void clear() {
    banks[0].clear();
    banks[1].clear();
    bank = 0;
    size[0] = size[1] = 1;
    modulation_bank = 0;
    shut = false;
    failsafe_ms = counts() ? 500 : 0;
  }
  bool sounds() {
    for (int k = 0; k < size[bank] && !shut; ++k) {
      for (const auto& [phase, intensity] : banks[bank][k])
        if (intensity > 0) return true;
    }
    return false;
  }
};

class MadeUpChain {
 public:
  MadeUpChain(int protocol, std::size_t count) : units(count) {
    for (MadeUpUnit& unit : units) {
      unit.protocol = protocol;
      unit.minor = protocol == 2 ? 11 : protocol == 3 ? 12 : 13;
      unit.clear();
      unit.failsafe_ms = unit.counts() ? 500 : 0;
    }
  }
  std::vector<MadeUpUnit> units;
  std::size_t strangers = 0;  ///< datagrams that were sent to nobody
  std::size_t to_units = 0;
  double now_s = 0, set_s = 0, lock_s = 0.2;
  std::function<void(const Bytes&, int unit)> on_frame;
  bool has_more = false;  ///< something is connected behind the last unit

  Endpoint group() const {
    Endpoint out{.scope = 7, .port = 44336};
    out.address[0] = 0xff;
    out.address[1] = 2;
    out.address[15] = 1;
    return out;
  }
  double unit_s() const { return now_s - set_s; }

  void take(const Endpoint& to, Bytes bytes) {
    if (to == group()) {
      for (std::size_t u = 0; u < units.size(); ++u) {
        if (u > 0 && !units[u - 1].far_open) break;
        hear(u, bytes, true);
      }
      return;
    }
    ++to_units;
    for (std::size_t u = 0; u < units.size(); ++u) {
      if (to != unit_address(units[u].id) || (u > 0 && !units[u - 1].far_open)) continue;
      return hear(u, bytes, false);
    }
    ++strangers;
  }

  void serve(double to_s) {
    now_s = to_s;
    for (std::size_t u = 0; u < units.size(); ++u) {
      MadeUpUnit& unit = units[u];
      carry_out(u);
      if (set_s > 0 && now_s > set_s + lock_s) unit.locked = unit.id != 0xff;
      if (unit.heard_s >= 0 && unit.failsafe_ms > 0 && now_s > unit.heard_s + 1e-3 * unit.failsafe_ms) unit.shut = true;
      if (unit.heard_s >= 0 && drop_at_s_ >= 0 && now_s > drop_at_s_) unit.heard_s = -1;
    }
    if (drop_at_s_ >= 0 && now_s > drop_at_s_) {
      drop_at_s_ = -1;
      for (MadeUpUnit& unit : units) {
        unit.id = 0xff;
        unit.far_open = unit.locked = false;
      }
      set_s = 0;
    }
  }

  void reboot(std::size_t u) {
    MadeUpUnit& unit = units[u];
    unit.clear();
    unit.id = 0xff;
    unit.far_open = unit.locked = false;
    unit.heard_s = -1;
  }

  struct Answer {
    Bytes bytes;
    Endpoint from;
  };
  std::deque<Answer> answers;

 private:
  void answer(std::size_t u, Bytes bytes) {
    if (units[u].mute) return;
    answers.push_back({std::move(bytes), unit_address(units[u].id)});
  }
  std::uint8_t flags(std::size_t u) const {
    const MadeUpUnit& unit = units[u];
    return static_cast<std::uint8_t>((unit.id != 0xff ? 1 : 0) | (unit.far_open ? 2 : 0) |
                                     (u + 1 < units.size() ? 4 : 0) | (unit.pulse ? 8 : 0) | (unit.locked ? 16 : 0) |
                                     (unit.first ? 32 : 0) | (unit.shut && !unit.counts() ? 64 : 0));
  }

  void hear(std::size_t u, const Bytes& bytes, bool by_group) {
    MadeUpUnit& unit = units[u];
    if (unit.mute || bytes.size() < 4) return;
    const int kind = bytes[1];
    const Bytes head{static_cast<std::uint8_t>(unit.protocol), bytes[1], bytes[2], bytes[3]};
    const auto say = [&](std::initializer_list<int> more) {
      Bytes out = head;
      for (const int byte : more)
        out.push_back(static_cast<std::uint8_t>(byte));
      answer(u, out);
    };
    if (bytes[0] != unit.protocol) return say({1});
    switch (kind) {
      case 0:
        if (by_group || unit.id == 0xff) return;
        if (unit.lose > 0) {
          --unit.lose;
          return;
        }
        for (int times = unit.repeat > 0 ? 2 : 1; times > 0; --times)
          queue_frame(u, bytes);
        unit.repeat = std::max(0, unit.repeat - 1);
        return;
      case 1:
        if (unit.counts())
          return say({0, unit.id, flags(u), 0, 0, 0, unit.minor, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
        return say({0, unit.id, flags(u), 0, 0, 0, 0});
      case 2:
        drop_at_s_ = now_s + 0.02;
        return say({0});
      case 3:
        if (unit.id == 0xff) say({0});
        return;
      case 4:
        if (by_group || unit.id != 0xff) return;
        EXPECT_EQ(bytes.size(), 6u);
        unit.id = bytes[4];
        unit.first = bytes[5] == 1;
        return say({0});
      case 5:
        unit.far_open = true;
        return say({0, u + 1 < units.size() || has_more ? 1 : 0});
      case 6:
        EXPECT_EQ(bytes.size(), 12u);
        set_s = now_s;
        return say({unit.id == 0 ? 0 : 4});
      case 7:
        unit.heard_s = now_s;
        return answer_frame(u, bytes, 0, {});
    }
  }

  void queue_frame(std::size_t u, const Bytes& bytes) {
    MadeUpUnit& unit = units[u];
    if (unit.queue_full > 0 || unit.queue.size() >= 7) {
      unit.queue_full = std::max(0, unit.queue_full - 1);
      return;
    }
    unit.frames.push_back(bytes);
    if (on_frame) on_frame(bytes, static_cast<int>(u));
    double at_s = now_s;
    if (unit.protocol != 2) {
      const std::uint32_t at = bytes[6] | bytes[7] << 8 | bytes[8] << 16 | static_cast<std::uint32_t>(bytes[9]) << 24;
      if (at != 0) at_s = set_s + 1e-6 * at;
    }
    unit.heard_s = now_s;
    unit.queue.push_back({at_s, bytes, {}});
    carry_out(u);
  }

  void carry_out(std::size_t u) {
    MadeUpUnit& unit = units[u];
    while (!unit.queue.empty() && unit.queue.front().at_s <= now_s + 1e-9) {
      const Bytes bytes = unit.queue.front().bytes;
      unit.queue.pop_front();
      const int sequence = bytes[4], command = bytes[5];
      if (unit.counts()) {
        if (command == 0) {
          unit.ack = 0xff;
          unit.last_command = 0;
          answer_frame(u, bytes, 0, {});
          continue;
        }
        if (sequence != ((unit.ack + 1) & 0xff)) {  // also a repeated one: the old result
          answer_frame(u, bytes, 0, {});
          continue;
        }
        unit.ack = sequence;
        unit.last_command = command;
      }
      unit.commands.push_back(command);
      Bytes data;
      const int status = act(u, command, Bytes(bytes.begin() + (unit.protocol == 2 ? 6 : 10), bytes.end()), data);
      EXPECT_EQ(status, 0) << "command " << command;
      answer_frame(u, bytes, status, data);
    }
  }

  void answer_frame(std::size_t u, const Bytes& to, int status, const Bytes& data) {
    MadeUpUnit& unit = units[u];
    if (to[1] == 0 && unit.lose_answers > 0) {
      --unit.lose_answers;
      return;
    }
    Bytes out{to[0],
              to[1],
              to[2],
              to[3],
              static_cast<std::uint8_t>(unit.counts() ? unit.ack : 0),
              static_cast<std::uint8_t>(status),
              flags(u),
              static_cast<std::uint8_t>(unit.id)};
    const auto ns = static_cast<std::uint64_t>(1e9 * unit_s());
    for (int i = 0; i < 8; ++i)
      out.push_back(static_cast<std::uint8_t>(ns >> (8 * i)));
    out.insert(out.end(), data.begin(), data.end());
    answer(u, out);
  }

  int act(std::size_t u, int command, const Bytes& p, Bytes& data) {
    MadeUpUnit& unit = units[u];
    const auto pattern = [&](std::size_t at) {
      MadeUpUnit::Pattern out;
      for (std::size_t t = 0; t < 249; ++t) {
        if (unit.counts()) {
          out.emplace_back(p.at(at + t), p.at(at + 249 + t));
        } else {
          out.emplace_back(p.at(at + 2 * t), p.at(at + 2 * t + 1));
        }
      }
      return out;
    };
    const auto sounds = [&](int bank) {
      unit.bank = bank;
      unit.shown_s.push_back(now_s);
      unit.shown.push_back(unit.banks[bank][0]);
    };
    switch (command) {
      case 0x01:
      case 0x30:
        return 0;
      case 0x03:
        unit.clear();
        return 0;
      case 0x05:
        if (unit.counts() || p.size() != 52) return 2;
        unit.failsafe_ms = p[34] | p[35] << 8;
        return 0;
      case 0x11:
        if (p.size() != 14) return 2;
        unit.foci[p[0]] = p[1] == 0;
        unit.divider[p[0]] = p[2] | p[3] << 8;
        unit.size[p[0]] = p[4];
        return 0;
      case 0x10:
        for (std::size_t k = 0; 6 + 8 * k < p.size(); ++k)  // its intensity, and the lowest byte of its x
          unit.banks[p[0]][static_cast<int>(k)] = {{p[6 + 8 * k], (p[12 + 8 * k] >> 6 | p[13 + 8 * k] << 2) & 255}};
        return 0;
      case 0x13:
        if (p.size() != 6 + 249u * p[2] || p[1] != 8) return 2;
        for (std::size_t k = 0; k < p[2]; ++k) {
          MadeUpUnit::Pattern& to = unit.banks[p[0]][p[4] + static_cast<int>(k)];
          to.clear();
          for (std::size_t t = 0; t < 249; ++t)
            to.emplace_back(p[6 + 249 * k + t], p[3]);
        }
        return 0;
      case 0x20:
        unit.modulation[p[0]] = Bytes(p.begin() + 6, p.end());
        return 0;
      case 0x21:
        unit.modulation_divider[p[0]] = p[2] | p[3] << 8;
        return p[4] == unit.modulation[p[0]].size() ? 0 : 2;
      case 0x22:
        unit.modulation_bank = p[0];
        return 0;
      case 0x12:
        if (p.size() != 10) return 2;
        sounds(p[0]);
        return 0;
      case 0x15:
        if (p.size() != 4 + 498u * p[1]) return 2;
        for (int k = 0; k < p[1]; ++k)
          unit.banks[p[0]][p[2] + k] = pattern(4 + 498 * static_cast<std::size_t>(k));
        if (p[0] == unit.bank && p[2] == 0) sounds(p[0]);
        return 0;
      case 0x16:
        if (unit.protocol == 2 || p.size() != 508) return 2;
        unit.banks[p[0]].clear();
        unit.banks[p[0]][0] = pattern(10);
        unit.size[p[0]] = 1;
        unit.foci[p[0]] = false;
        sounds(p[0]);
        return 0;
      case 0xe7:
        data = {static_cast<std::uint8_t>(unit.shut && unit.counts() ? 0x80 : 0)};
        return 0;
      case 0xe8:
        data.assign(unit.protocol == 5 ? 27 : 35, 0);
        return 0;
      case 0xeb:
        data = {0, static_cast<std::uint8_t>(unit.minor), 0, 0, static_cast<std::uint8_t>(unit.minor), 0, 0x80, 2};
        return 0;
      default:
        return 1;
    }
  }

  double drop_at_s_ = -1;
};

/// The cable to it.
class MadeUpCable final : public driver::autd3_udp::Cable {
 public:
  explicit MadeUpCable(MadeUpChain& chain) : chain_(chain), waits_(eventfd(1, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  Endpoint group() const override { return chain_.group(); }
  void send(const Endpoint& to, std::span<const std::uint8_t> datagram) override {
    chain_.take(to, Bytes(datagram.begin(), datagram.end()));
  }
  std::optional<std::size_t> receive(std::span<std::uint8_t> into, Endpoint& from) override {
    if (chain_.answers.empty()) return std::nullopt;
    const MadeUpChain::Answer answer = chain_.answers.front();
    chain_.answers.pop_front();
    from = answer.from;
    std::copy_n(answer.bytes.begin(), std::min(answer.bytes.size(), into.size()), into.begin());
    return answer.bytes.size();
  }
  /// Ready if there are answers: a descriptor that can always be read, or none.
  pollfd watched() const override { return {chain_.answers.empty() ? -1 : waits_.get(), POLLIN, 0}; }

 private:
  MadeUpChain& chain_;
  Descriptor waits_;
};

/// A board on it, as its guard has it.
struct ChainRig {
  MadeUpChain chain;
  array::Layout layout;
  ServedClock clock{[this] { chain.serve(clock.now_s()); }};
  KeptNotes notes;
  std::unique_ptr<driver::Board> board;
  array::Drive drive, drives, silence;
  std::uint64_t slot = 0;
  double slot_s = 2e-3;

  ChainRig(int protocol, std::size_t count) : chain(protocol, count), layout(array::load_layout("autd3")) {
    const array::Layout one = layout;
    layout.name = "chain";
    for (std::size_t u = 1; u < count; ++u) {
      layout.transducers.insert(layout.transducers.end(), one.transducers.begin(), one.transducers.end());
      layout.boards.push_back(one.boards[0]);
      layout.boards.back().first = static_cast<std::uint32_t>(249 * u);
    }
    drive.resize(layout.transducers.size());
    silence.assign(drive.size(), {0.0f, 0.0f});
    chain.now_s = clock.now_s();
  }
  ChainRig(const ChainRig&) = delete;
  ChainRig& operator=(const ChainRig&) = delete;

  std::unique_ptr<driver::Board> make() {
    return driver::autd3_udp::open_board({.layout = layout, .slot_s = slot_s}, notes,
                                         std::make_unique<MadeUpCable>(chain), clock);
  }
  void open() { board = make(); }
  /// Number `n` in the phases of all transducers.
  void play(int n) {
    const double turns = n / 256.0;
    std::ranges::fill(drive,
                      array::TransducerDrive{1.0f, static_cast<float>(2 * M_PI * (turns - (turns > 0.5 ? 1 : 0)))});
    board->play(slot, drive);
  }
  /// `parts` drives, part p with phases of p steps and that intensity; from the slot on.
  void plan(std::size_t parts, const std::function<float(std::size_t part, std::size_t transducer)>& amplitude,
            double hz = 0, const std::vector<Vec3>& foci = {}) {
    drives.resize(parts * silence.size());
    for (std::size_t i = 0; i < drives.size(); ++i) {
      const std::size_t part = i / silence.size();
      drives[i] = {amplitude(part, i % silence.size()), static_cast<float>(2 * M_PI * static_cast<double>(part) / 256)};
    }
    const session::Cycle cycle{.plays = session::Plays::pattern,
                               .length = static_cast<std::uint32_t>(parts),
                               .modulation_hz = hz,
                               .modulation = array::Modulation::amplitude_sine};
    board->plan({{{slot, slot + 1000000, cycle}, clock.now_s(), slot_s}, drives, foci});
  }
  /// Until the next slot, as a guard does.
  void pass(double seconds) {
    for (const double end_s = clock.now_s() + seconds; clock.now_s() < end_s - 1e-9;) {
      clock.sleep_s(0.5e-3);
      board->tend();
    }
  }
  void next_slot() {
    pass(slot_s);
    ++slot;
  }
  std::size_t sounding() {
    return static_cast<std::size_t>(std::ranges::count_if(chain.units, [](MadeUpUnit& unit) { return unit.sounds(); }));
  }
  bool silent_within(double seconds) {
    for (const double end_s = clock.now_s() + seconds; clock.now_s() < end_s; pass(0.5e-3)) {
      if (sounding() == 0) return true;
    }
    return sounding() == 0;
  }
};

}  // namespace palpa::test
