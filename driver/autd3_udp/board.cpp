#include "driver/autd3_udp/board.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "base/error.hpp"
#include "driver/autd3_udp/units.hpp"
#include "driver/autd3_udp/wire.hpp"
#include "driver/fixed_text.hpp"
#include "session/links/hand_over.hpp"

namespace palpa::driver::autd3_udp {
namespace {

constexpr double wait_s = 5e-3, told_s = 1, retry_s = 1, close_s = 0.7, counters_s = 0.1;
constexpr double listen_s = 0.3;  ///< for the list of interfaces
/// A drive sounds that long after its slot begins, besides the time that it takes on the cable: for answers and the
/// guard's turns. At most so many slots, so that no more frames wait in a unit than palpa allows.
constexpr double lead_s = 1.5e-3, most_lead_slots = 2.5;
constexpr double least_ahead_s = 0.3e-3;  ///< of a drive that comes too late for its slot

void check(const array::Layout& layout) {
  if (boards_of_type(layout, "autd3", transducers) == 0)
    throw bad_input("layout " + layout.name,
                    "link autd3-udp drives AUTD3 units only, such as those of autd3 and paper");
  if (layout.boards.size() > most_units)
    throw bad_input("layout " + layout.name, fmt::format("link autd3-udp drives at most {} units", most_units));
}

const array::BoardType& type() {
  return *array::find_board_type("autd3");
}

/// When slots begin, though drives come late: never earlier than the earliest drive says.
class SlotTimes {
 public:
  explicit SlotTimes(double slot_s) : slot_s_(slot_s) {}
  double begin(std::uint64_t slot, double now_s) {
    constexpr double creep = 0.01, jump_s = 0.05;
    const double zero_s = now_s - static_cast<double>(slot) * slot_s_;
    if (!known_ || std::abs(zero_s - zero_s_) > jump_s) zero_s_ = zero_s;
    zero_s_ = std::min(zero_s, zero_s_ + creep * (zero_s - zero_s_));
    known_ = true;
    return zero_s_ + static_cast<double>(slot) * slot_s_;
  }

 private:
  double slot_s_, zero_s_ = 0;
  bool known_ = false;
};

class UdpBoard final : public Board {
 public:
  /// `notes` and `clock` must outlive this object.
  UdpBoard(const BoardSpec& spec, BoardNotes& notes, std::unique_ptr<Cable> cable, Clock& clock)
      : notes_(notes),
        clock_(clock),
        changes_(array::changes_of(&type(), {.slot_s = spec.slot_s, .nulls = spec.nulls})),
        cable_(std::move(cable)),
        units_(*cable_, spec.layout.boards.size(), spec.layout.name,
               {.amplitude_steps = static_cast<std::uint16_t>(changes_.amplitude_steps),
                .phase_steps = static_cast<std::uint16_t>(changes_.phase_steps)}),
        times_(spec.slot_s),
        // All units' frames pass the cable to the first one.
        cable_s_(static_cast<double>(spec.layout.boards.size() * pattern_bytes) / cable_bytes_per_s),
        lead_s_(std::max(std::min(cable_s_ + lead_s, most_lead_slots * spec.slot_s), cable_s_)),
        drive_(spec.layout.transducers.size()) {
    if (const auto why = array::why_fewer_steps(&type(), {.slot_s = spec.slot_s, .nulls = spec.nulls}); !why.empty())
      notes_.warning(why);
    units_.open(clock_.now_s());
    double waits_since_s = clock_.now_s();
    for (bool told = false; !units_.ready();) {
      wait();
      const double now_s = clock_.now_s();
      units_.pump(now_s);
      if (units_.closed()) throw failure(std::string(units_.fault()));
      if (!units_.waits_for_clocks()) waits_since_s = now_s;
      if (!told && now_s > waits_since_s + told_s) {
        told = true;
        notes_.waits("waiting until the units agree on the time");
      }
    }
  }

  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    if (!session::sounds(drive)) {
      sounding_ = waiting_ = false;
      advance();
      return;
    }
    const double now_s = clock_.now_s();
    std::transform(drive.begin(), drive.end(), drive_.begin(), autd3::emission);
    at_s_ = std::max(times_.begin(slot, now_s) + lead_s_, now_s + cable_s_ + least_ahead_s);
    sounding_ = waiting_ = true;
    wipes_ = false;
    advance();
  }

  /// Silences both banks: nothing that a unit could change to sounds afterwards.
  void all_off() override {
    sounding_ = waiting_ = false;
    wipes_ = true;
    advance();
  }

  void tend() override { advance(); }

  BoardCounts counts() const override { return {submitted_, {units_.drives_there(), 0}, 0, lost_}; }

  std::span<const pollfd> watched() override {
    watched_ = units_.watched();
    if (watched_.fd < 0) return {};
    return {&watched_, 1};
  }

  bool close() override {
    const double until_s = clock_.now_s() + close_s;
    const auto done = [&] {
      return units_.closed_silent() || (units_.ready() && is_silent() && (!wipes_ || wiped_) && units_.idle());
    };
    while (!done()) {
      if (clock_.now_s() >= until_s) return false;
      wait();
      advance();
    }
    tell();
    return true;
  }

 private:
  static constexpr std::size_t pattern_bytes = datagram_head + 6 + 10 + 2 * transducers + cable_overhead;

  void wait() { clock_.wait_s(wait_s, units_.watched()); }
  bool is_silent() const { return shown_ == Shown::silence; }

  /// Goes on with what waits, as far as the units have answered.
  void advance() {
    const double now_s = clock_.now_s();
    units_.pump(now_s);
    if (!units_.ready()) {
      if (units_.closed()) {
        if (!std::exchange(lost_, true)) {
          retry_at_s_ = now_s + 1e-3 * Units::failsafe_ms;
          notes_.warning(units_.fault());
        }
        if (now_s >= retry_at_s_) {
          retry_at_s_ = now_s + retry_s;
          units_.open(now_s);
        }
      }
      shown_ = Shown::unknown;
      waiting_ = false;
      return;
    }
    if (shown_ == Shown::unknown) {  // just opened, which cleared them
      shown_ = Shown::silence;
      wiped_ = true;
      bank_ = 0;
      bank_plays_ = false;
      if (std::exchange(lost_, false)) notes_.warning("the units are back");
    }
    if (!sounding_) {
      if (!is_silent()) return show_silence(now_s);
      if (wipes_ && !wiped_ && units_.idle()) wipe(now_s);
      return;
    }
    if (waiting_ && units_.takes()) show_drive(now_s);
  }

  /// Goes out although drives wait for their time.
  void show_silence(double now_s) {
    const std::size_t rounds = units_.protocol().carries_time || bank_plays_ ? 1 : 3;
    if (!units_.takes(queue_size + 1 - rounds)) return;
    show({}, 0, now_s, false);
    shown_ = Shown::silence;
    wiped_ = false;
  }

  void show_drive(double now_s) {
    waiting_ = false;
    ++submitted_.drives;
    show(drive_, at_s_, now_s, true);
    shown_ = Shown::drive;
  }

  /// Lets a pattern sound; empty: silence.
  void show(std::span<const Emission> drive, double at_s, double now_s, bool counts) {
    const Protocol& protocol = units_.protocol();
    const auto to_all = [&](Round round, bool last, const auto& put) {
      std::size_t unit = 0;
      for (Datagram& frame : units_.frames()) {
        put(frame, drive.empty() ? drive : drive.subspan(unit * transducers, transducers));
        ++unit;
      }
      units_.send(round, at_s, now_s, counts && last);
    };
    if (protocol.carries_time) {
      bank_ ^= 1;
      return to_all(Round::pattern, true,
                    [&](Datagram& to, auto pattern) { put_pattern_at_once(to, protocol, bank_, pattern); });
    }
    // Into the bank that plays, once that plays what is written.
    const bool plays = std::exchange(bank_plays_, true);
    if (!plays) bank_ ^= 1;
    to_all(Round::pattern, plays, [&](Datagram& to, auto pattern) { put_raw(to, protocol, bank_, 0, pattern); });
    if (plays) return;
    to_all(Round::part, false, [&](Datagram& to, auto) { put_configure_pattern(to, protocol, bank_, {}); });
    to_all(Round::part, true,
           [&](Datagram& to, auto) { put_activate(to, protocol, Command::activate_pattern, bank_); });
  }

  /// Silences the bank that does not sound, too, which then sounds.
  void wipe(double now_s) {
    bank_plays_ = false;
    show({}, 0, now_s, false);
    wiped_ = true;
  }

  void tell() {
    if (submitted_.drives == 0) return;
    if (units_.ready() && units_.protocol().carries_time) {
      for (Datagram& frame : units_.frames())
        put_command(frame, units_.protocol(), Command::read_counters);
      units_.send(Round::setting, 0, clock_.now_s());
      for (const double until_s = clock_.now_s() + counters_s; !units_.idle() && clock_.now_s() < until_s;) {
        wait();
        units_.pump(clock_.now_s());
      }
    }
    notes_.info(FixedText<160>("{} of {} drives carried out by all units, {} frames sent again, {} carried out late",
                               units_.drives_there(), submitted_.drives, units_.repeated(), units_.late())
                    .view());
  }

  enum class Shown { unknown, silence, drive };

  BoardNotes& notes_;
  Clock& clock_;
  array::Changes changes_;  ///< what their silencer does
  std::unique_ptr<Cable> cable_;
  Units units_;
  SlotTimes times_;
  double cable_s_, lead_s_;
  pollfd watched_{};

  // What should sound.
  bool sounding_ = false;
  bool waiting_ = false;  ///< drive_ has not been sent
  std::vector<Emission> drive_;
  double at_s_ = 0;     ///< when it is to sound
  bool wipes_ = false;  ///< also the bank that does not sound is to be silent
  // What the units do, or do soon.
  Shown shown_ = Shown::unknown;
  bool wiped_ = false;
  std::uint8_t bank_ = 0;    ///< that sounds
  bool bank_plays_ = false;  ///< protocol 2: it plays what is written to its first pattern
  session::Passed submitted_;
  bool lost_ = false;
  double retry_at_s_ = 0;
};

/// Names the interfaces on which units answer.
[[noreturn]] void refuse_no_interface() {
  std::string all;
  for (const Nic& nic : nics()) {
    if (!nic.up || !nic.ipv6) continue;
    UdpCable cable(group_of(nic.index));
    Datagram question;
    put_request(question, ask_byte, Kind::info, 1);
    cable.send(cable.group(), question.view());
    Clock& clock = steady_clock();
    std::vector<int> protocols;
    for (const double until_s = clock.now_s() + listen_s; clock.now_s() < until_s;) {
      clock.wait_s(until_s - clock.now_s(), cable.watched());
      std::array<std::uint8_t, 64> bytes{};
      Endpoint from;
      while (const auto size = cable.receive(bytes, from)) {
        const auto answer = parse_answer(std::span(bytes).first(std::min(*size, bytes.size())));
        if (!answer || !cable.may_come_from(from) || answer->status != status_wrong_protocol) continue;
        if (std::ranges::find(protocols, answer->protocol) == protocols.end()) protocols.push_back(answer->protocol);
      }
    }
    if (!protocols.empty())
      all += fmt::format("{}{} (protocol {})", all.empty() ? "" : ", ", nic.name, fmt::join(protocols, " and "));
  }
  throw bad_usage("link autd3-udp needs the network interface of the units, as in autd3-udp:enp3s0; " +
                  (all.empty() ? "no AUTD3 unit answers on any" : "AUTD3 units answer on " + all));
}

}  // namespace

std::unique_ptr<Board> open_board(const BoardSpec& spec, BoardNotes& notes, std::unique_ptr<Cable> cable,
                                  Clock& clock) {
  check(spec.layout);
  return std::make_unique<UdpBoard>(spec, notes, std::move(cable), clock);
}

BoardKind board_kind() {
  BoardKind kind{"autd3-udp", "autd3-udp:NIC: AUTD3 units on a network cable, firmware 0.10 to 0.13",
                 [](const BoardSpec& spec, BoardNotes& notes) {
                   check(spec.layout);
                   if (spec.argument.empty()) refuse_no_interface();
                   return open_board(spec, notes, std::make_unique<UdpCable>(parse_group(spec.argument)),
                                     steady_clock());
                 }};
  kind.own_layout = [](const std::string&) { return std::string("autd3"); };
  return kind;
}

}  // namespace palpa::driver::autd3_udp
