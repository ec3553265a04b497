#include "driver/autd3_udp/board.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "base/error.hpp"
#include "driver/autd3/pattern.hpp"
#include "driver/autd3_udp/units.hpp"
#include "driver/autd3_udp/wire.hpp"
#include "driver/fixed_text.hpp"
#include "driver/plan_tally.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/slots.hpp"

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

/// What one drive takes on the cable.
double cable_s(const array::Layout& layout) {
  constexpr std::size_t bytes = datagram_head + 6 + 10 + 2 * transducers + cable_overhead;
  return static_cast<double>(layout.boards.size() * bytes) / cable_bytes_per_s;
}

/// The shortest slot in which drives are sent one by one, in whole periods.
double stream_s(const array::Layout& layout) {
  constexpr double least_s = 0.2e-3, cable_share = 1.25, period_s = 1 / autd3::period_hz;
  return period_s * std::ceil(std::max(least_s, cable_share * cable_s(layout)) / period_s - 1e-6);
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
        layout_(spec.layout),
        slot_s_(spec.slot_s),
        sound_speed_m_s_(spec.sound_speed_m_s),
        divider_(autd3::divider_of(spec.slot_s, "autd3-udp")),
        changes_(array::changes_of(&type(), {.slot_s = spec.slot_s, .nulls = spec.nulls})),
        cable_(std::move(cable)),
        units_(*cable_, spec.layout.boards.size(), spec.layout.name,
               {.amplitude_steps = static_cast<std::uint16_t>(changes_.amplitude_steps),
                .phase_steps = static_cast<std::uint16_t>(changes_.phase_steps)}),
        times_(spec.slot_s),
        // All units' frames pass the cable to the first one.
        cable_s_(cable_s(spec.layout)),
        lead_s_(std::max(std::min(cable_s_ + lead_s, most_lead_slots * spec.slot_s), cable_s_)),
        streams_(spec.slot_s >= stream_s(spec.layout)),
        loading_(spec.layout.transducers.size(), session::most_cycle),
        newest_(spec.layout.transducers.size(), session::most_cycle),
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
      silence();
      return advance();
    }
    if (fresh_ && newest_way_ == Way::slots) take_newest();
    const autd3::Pattern& pattern = fresh_ ? newest_ : loading_;
    const bool planned = !pattern.empty() && slot < pattern.until_slot();
    wipes_ = false;
    if (planned && (fresh_ ? newest_way_ : way_) != Way::slots) {
      if (!std::exchange(sounding_, true) && !fresh_) restart();  // a silenced pattern is sent again
      allow_start(pattern);
      tally_.play();
      return advance();
    }
    const double now_s = clock_.now_s();
    if (planned) {
      const auto part = pattern.part(slot % pattern.parts());
      std::copy(part.begin(), part.end(), drive_.begin());
      wanted_ = {pattern.modulation_hz(), pattern.modulation()};
    } else {
      std::transform(drive.begin(), drive.end(), drive_.begin(), autd3::emission);
      wanted_ = {};
    }
    at_s_ = std::max(times_.begin(slot, now_s) + lead_s_, now_s + cable_s_ + least_ahead_s);
    sounding_ = waiting_ = true;
    advance();
  }

  void plan(const BoardPlan& plan) override {
    waiting_ = false;
    if (!plan.slots.cycle.is_listed()) {
      if (plan.slots.cycle.plays == session::Plays::nothing) silence();
      fresh_ = false;
      restart();
      newest_.clear();
      loading_.clear();
      return advance();
    }
    newest_.encode(plan);
    newest_way_ = way_of(newest_);
    fresh_ = sounding_ = true;
    wipes_ = false;
    allow_start(newest_);
    advance();
  }

  /// Silences both banks: nothing that a unit could change to sounds afterwards.
  void all_off() override {
    silence();
    wipes_ = true;
    advance();
  }

  void tend() override { advance(); }

  BoardCounts counts() const override {
    BoardCounts counts = tally_.counts(lost_);
    counts.completed.drives += units_.drives_there();
    counts.late = late_;
    return counts;
  }

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
  /// How units play a pattern.
  enum class Way {
    one,    ///< its only drive, until another comes
    slots,  ///< each drive is sent for its slot
    foci,   ///< by their own clock, from foci
    raw,    ///< by their own clock, from drives
  };
  Way way_of(const autd3::Pattern& pattern) const {
    if (pattern.parts() == 1) return Way::one;
    if (autd3::can_be_foci(pattern, layout_, sound_speed_m_s_)) return Way::foci;
    return streams_ && !pauses(pattern) ? Way::slots : Way::raw;
  }

  /// Whether a drive of it is silent. A guard does not pass such a drive on: it is part of the pattern.
  static bool pauses(const autd3::Pattern& pattern) {
    for (std::uint32_t part = 0; part < pattern.parts(); ++part) {
      if (std::ranges::all_of(pattern.part(part), [](const Emission& e) { return e.intensity == 0; })) return true;
    }
    return false;
  }

  void wait() { clock_.wait_s(wait_s, units_.watched()); }
  bool is_silent() const { return shown_ == Shown::silence; }

  /// Allows for the time until the first drive of a plan is heard.
  void allow_start(const autd3::Pattern& pattern) {
    constexpr double round_s = 1e-3, beside = 6;  // modulation, silence, what is on its way
    tally_.allow(static_cast<std::uint64_t>(
        std::ceil((lead_s_ + round_s * (beside + 0.5 * pattern.parts() / Units::window)) / slot_s_)));
  }

  void silence() {
    tally_.gone();
    sounding_ = waiting_ = false;
    restart();
    if (fresh_) take_newest();  // it is sent again
  }

  void restart() {
    place_ = 0;
    configured_ = activated_ = there_ = false;
  }

  void take_newest() {
    std::swap(loading_, newest_);
    fresh_ = false;
    restart();
    std::swap(way_, newest_way_);
    if (way_ != Way::slots) return;
    tally_.sent();
    tally_.there();
  }

  /// Goes on with what waits, as far as the units have answered.
  void advance() {
    const double now_s = clock_.now_s();
    units_.pump(now_s);
    if (!units_.ready()) return wait_for_units(now_s);
    if (shown_ == Shown::unknown) {  // just opened, which cleared them
      shown_ = Shown::silence;
      wiped_ = true;
      bank_ = modulation_bank_ = 0;
      bank_plays_ = false;
      played_ = {};
      modulation_written_ = false;
      if (std::exchange(lost_, false)) notes_.warning("the units are back");
    }
    if (!sounding_) {
      if (!is_silent()) return show_silence(now_s);
      if (wipes_ && !wiped_ && units_.idle()) wipe(now_s);
      return;
    }
    while (units_.takes() && send_next(now_s)) {
    }
  }

  void wait_for_units(double now_s) {
    if (units_.closed()) {
      if (!std::exchange(lost_, true)) {
        retry_at_s_ = now_s + 1e-3 * Units::failsafe_ms;
        notes_.warning(units_.fault());
        tally_.lost();
      }
      if (now_s >= retry_at_s_) {
        retry_at_s_ = now_s + retry_s;
        units_.open(now_s);
      }
    }
    shown_ = Shown::unknown;
    waiting_ = false;
    restart();
  }

  /// Sends the next round of what should sound. Returns false if nothing waits, or answers are needed first.
  bool send_next(double now_s) {
    const bool between = !started() || activated_;
    if (fresh_ && between) take_newest();
    const bool planned = !loading_.empty() && way_ != Way::slots;
    if (planned) wanted_ = {loading_.modulation_hz(), loading_.modulation()};
    if (planned && activated_) {
      if (!there_ && units_.done(activation_)) {
        there_ = true;
        tally_.there();
      }
    }
    if (!(planned && !activated_) && !waiting_) return false;
    if (!(wanted_ == played_)) return send_modulation(now_s);
    if (planned && !activated_) return send_plan(now_s);
    waiting_ = false;
    tally_.drive_sent();
    show(drive_, at_s_, now_s, true);
    return true;
  }

  bool started() const { return place_ > 0; }

  // ---- modulation --------------------------------------------------------------------------------------------------

  struct Wave {
    double hz = 0;
    array::Modulation modulation = array::Modulation::pressure_sine;
    bool operator==(const Wave& other) const { return hz == other.hz && (hz == 0 || modulation == other.modulation); }
  };

  /// Into the bank that is not heard; once that is there, it is heard.
  bool send_modulation(double now_s) {
    const Protocol& protocol = units_.protocol();
    const std::uint8_t idle = modulation_bank_ ^ 1;
    if (modulation_written_ && written_ == wanted_) {
      if (!units_.idle()) return false;
      to_all(Round::setting, 0, now_s,
             [&](Datagram& to, std::size_t) { put_activate(to, protocol, Command::activate_modulation, idle); });
      modulation_bank_ = idle;
      modulation_written_ = false;
      played_ = wanted_;
      return true;
    }
    if (!units_.idle()) return false;
    const autd3::ModulationSamples samples =
        autd3::modulation_samples(wanted_.hz, wanted_.modulation, loading_.begin_s(), units_day_s(), now_s);
    to_all(Round::setting, 0, now_s, [&](Datagram& to, std::size_t) {
      put_modulation(to, protocol, idle, 0, std::span(samples.samples).first(samples.count));
    });
    to_all(Round::setting, 0, now_s, [&](Datagram& to, std::size_t) {
      put_configure_modulation(to, protocol, idle, samples.divider, static_cast<std::uint32_t>(samples.count));
    });
    written_ = wanted_;
    modulation_written_ = true;
    return true;
  }

  /// What the old link's patterns call the time of day: the units count from 0.
  double units_day_s() const { return units_.clock_ahead_s() + autd3::epoch_s; }

  // ---- plans -------------------------------------------------------------------------------------------------------

  /// The next frame of a plan for the bank that does not sound; when all are there, it sounds.
  bool send_plan(double now_s) {
    const Protocol& protocol = units_.protocol();
    wiped_ = false;
    if (way_ == Way::one) {
      const auto part = loading_.part(0);
      std::copy(part.begin(), part.end(), drive_.begin());
      show(drive_, now_s + lead_s_, now_s, false);
      return end_plan(units_.newest());
    }
    const std::uint8_t idle = bank_ ^ 1;
    const std::uint32_t parts = loading_.parts();
    if (place_ == 0 && !units_.idle()) return false;  // the idle bank may be about to be left
    if (place_ == 0) turn_.follow(loading_.begin_s(), loading_.slot_s(), units_day_s());
    if (place_ < parts) {
      const std::uint32_t count =
          way_ == Way::foci
              ? parts
              : std::min<std::uint32_t>(loading_.even() && same_intensities() ? phases_in_frame : raw_in_frame,
                                        parts - place_);
      to_all(Round::part, 0, now_s, [&](Datagram& to, std::size_t unit) { put_parts(to, unit, idle, count); });
      place_ += count;
      return true;
    }
    if (!configured_) {
      const bool foci = way_ == Way::foci;
      to_all(Round::part, 0, now_s, [&](Datagram& to, std::size_t) {
        put_configure_pattern(to, protocol, idle,
                              {.divider = divider_,
                               .size = parts,
                               .foci_a_sample = static_cast<std::uint8_t>(foci ? 1 : 0),
                               .sound_speed_m_s = foci ? sound_speed_m_s_ : 0});
      });
      configured_ = true;
      return true;
    }
    if (!units_.idle()) return false;
    bank_ = idle;
    bank_plays_ = false;
    const std::uint64_t number = to_all(Round::pattern, now_s + lead_s_, now_s, [&](Datagram& to, std::size_t) {
      put_activate(to, protocol, Command::activate_pattern, idle);
    });
    shown_ = Shown::drive;
    wiped_ = false;
    return end_plan(number);
  }

  bool end_plan(std::uint64_t round) {
    place_ = std::max(place_, 1U);
    activated_ = true;
    activation_ = round;
    tally_.sent();
    return true;
  }

  /// Whether all drives of the plan have one and the same intensity.
  bool same_intensities() const {
    for (std::uint32_t part = 1; part < loading_.parts(); ++part) {
      if (loading_.part(part)[0].intensity != loading_.part(0)[0].intensity) return false;
    }
    return true;
  }

  /// `count` parts of the plan from place_ on. Units begin their count of parts at their time 0.
  void put_parts(Datagram& to, std::size_t unit, std::uint8_t bank, std::uint32_t count) const {
    const Protocol& protocol = units_.protocol();
    const std::uint32_t parts = loading_.parts();
    if (way_ == Way::foci) {
      std::array<FixedPoint, session::most_cycle> foci;
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t part = turn_.part_at(i, parts);
        foci[i] = autd3::fixed_point(loading_.foci()[part], layout_, unit);
        foci[i].intensity = loading_.part(part)[0].intensity;
      }
      return put_foci(to, protocol, bank, 0, std::span(foci).first(count));
    }
    std::array<Emission, phases_in_frame * transducers> some;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto part = loading_.part(turn_.part_at(place_ + i, parts)).subspan(unit * transducers, transducers);
      std::copy(part.begin(), part.end(), some.begin() + static_cast<std::ptrdiff_t>(i * transducers));
    }
    const auto first = static_cast<std::uint16_t>(place_);
    const auto drives = std::span(some).first(count * transducers);
    if (loading_.even() && same_intensities()) return put_phases(to, protocol, bank, first, drives);
    put_raw(to, protocol, bank, first, drives);
  }

  // ---- single drives -----------------------------------------------------------------------------------------------

  /// Goes out although drives wait for their time.
  void show_silence(double now_s) {
    const std::size_t rounds = units_.protocol().carries_time || bank_plays_ ? 1 : 3;
    if (!units_.takes(queue_size + 1 - rounds)) return;
    show({}, 0, now_s, false);
    shown_ = Shown::silence;
    wiped_ = false;
  }

  template <typename Put>
  std::uint64_t to_all(Round round, double at_s, double now_s, const Put& put, bool counts = false) {
    std::size_t unit = 0;
    for (Datagram& frame : units_.frames())
      put(frame, unit++);
    return units_.send(round, at_s, now_s, counts);
  }

  /// Lets one drive sound; empty: silence.
  void show(std::span<const Emission> drive, double at_s, double now_s, bool counts) {
    const Protocol& protocol = units_.protocol();
    const auto of = [&](std::size_t unit) {
      return drive.empty() ? drive : drive.subspan(unit * transducers, transducers);
    };
    shown_ = Shown::drive;
    wiped_ = false;
    if (protocol.carries_time) {
      bank_ ^= 1;
      to_all(
          Round::pattern, at_s, now_s,
          [&](Datagram& to, std::size_t unit) { put_pattern_at_once(to, protocol, bank_, of(unit)); }, counts);
      return;
    }
    // Into the bank that plays, once that plays what is written.
    const bool plays = std::exchange(bank_plays_, true);
    if (!plays) bank_ ^= 1;
    to_all(
        Round::pattern, 0, now_s, [&](Datagram& to, std::size_t unit) { put_raw(to, protocol, bank_, 0, of(unit)); },
        counts && plays);
    if (plays) return;
    to_all(Round::part, 0, now_s, [&](Datagram& to, std::size_t) { put_configure_pattern(to, protocol, bank_, {}); });
    to_all(
        Round::part, 0, now_s,
        [&](Datagram& to, std::size_t) { put_activate(to, protocol, Command::activate_pattern, bank_); }, counts);
  }

  /// Silences the bank that does not sound, too, which then sounds.
  void wipe(double now_s) {
    bank_plays_ = false;
    show({}, 0, now_s, false);
    shown_ = Shown::silence;
    wiped_ = true;
  }

  void tell() {
    const BoardCounts all = counts();
    if (all.submitted.drives == 0) return;
    if (units_.ready() && units_.protocol().carries_time) {
      const double now_s = clock_.now_s();
      to_all(Round::setting, 0, now_s,
             [&](Datagram& to, std::size_t) { put_command(to, units_.protocol(), Command::read_counters); });
      while (!units_.idle() && clock_.now_s() < now_s + counters_s) {
        wait();
        units_.pump(clock_.now_s());
      }
      if (units_.idle()) late_ = units_.late();
    }
    notes_.info(FixedText<160>("{} of {} drives carried out by all units, {} frames sent again", all.completed.drives,
                               all.submitted.drives, units_.repeated())
                    .view());
  }

  enum class Shown { unknown, silence, drive };

  BoardNotes& notes_;
  Clock& clock_;
  array::Layout layout_;
  double slot_s_, sound_speed_m_s_;
  std::uint16_t divider_;   ///< periods of a slot
  array::Changes changes_;  ///< what their silencer does
  std::unique_ptr<Cable> cable_;
  Units units_;
  SlotTimes times_;
  double cable_s_, lead_s_;
  bool streams_;
  pollfd watched_{};

  // What should sound.
  bool sounding_ = false;
  bool waiting_ = false;  ///< drive_ has not been sent
  bool fresh_ = false;    ///< newest_ has not been taken
  autd3::Pattern loading_, newest_;
  Way way_ = Way::one, newest_way_ = Way::one;
  std::uint32_t place_ = 0;  ///< parts of loading_ that have been sent
  bool configured_ = false, activated_ = false, there_ = false;
  std::uint64_t activation_ = 0;  ///< the round that lets it sound
  autd3::PartOffset turn_;
  std::vector<Emission> drive_;
  double at_s_ = 0;     ///< when drive_ is to sound
  bool wipes_ = false;  ///< also the bank that does not sound is to be silent
  Wave wanted_;
  // What the units do, or do soon.
  Shown shown_ = Shown::unknown;
  bool wiped_ = false;
  std::uint8_t bank_ = 0, modulation_bank_ = 0;  ///< that are heard
  bool bank_plays_ = false;                      ///< protocol 2: it plays what is written to its first pattern
  Wave played_, written_;
  bool modulation_written_ = false;  ///< written_ is in the other bank
  PlanTally tally_;
  std::optional<std::uint64_t> late_;
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
                 },
                 true};
  kind.own_layout = [](const std::string&) { return std::string("autd3"); };
  kind.single_drive_s = stream_s;
  return kind;
}

}  // namespace palpa::driver::autd3_udp
