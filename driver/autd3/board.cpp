#include "driver/autd3/board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>
#include <utility>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "base/error.hpp"
#include "driver/autd3/pattern.hpp"
#include "driver/autd3/remote.hpp"
#include "driver/fixed_text.hpp"
#include "driver/guard/channel.hpp"
#include "driver/plan_tally.hpp"
#include "session/links/slots.hpp"

namespace palpa::driver::autd3 {
namespace {

constexpr double open_patience_s = 3, close_patience_s = 0.5, retry_s = 1;

void check(const array::Layout& layout) {
  if (boards_of_type(layout, "autd3", transducers) == 0)
    throw bad_input("layout " + layout.name, "link autd3 drives AUTD3 units only, such as those of autd3 and paper");
}

const array::BoardType& type() {
  return *array::find_board_type("autd3");
}

class Autd3Board final : public Board {
 public:
  /// `notes` and `clock` must outlive this object.
  Autd3Board(const BoardSpec& spec, BoardNotes& notes, const Address& address, Clock& clock)
      : notes_(notes),
        clock_(clock),
        divider_(divider_of(spec.slot_s)),
        changes_(array::changes_of(&type(), {.slot_s = spec.slot_s, .nulls = spec.nulls})),
        count_(spec.layout.transducers.size()),
        layout_(spec.layout),
        sound_speed_m_s_(spec.sound_speed_m_s),
        remote_(address, spec.layout),
        loading_(count_, session::most_cycle),
        newest_(count_, session::most_cycle),
        drive_(count_) {
    if (const auto why = array::why_fewer_steps(&type(), {.slot_s = spec.slot_s, .nulls = spec.nulls}); !why.empty())
      notes_.warning(why);
    remote_.connect(clock_.now_s());
    double until_s = clock_.now_s() + open_patience_s;
    for (bool told = false; !ready();) {
      if (remote_.closed()) throw failure(std::string(remote_.fault()));
      if (remote_.waits_for_bus(clock_.now_s())) {
        until_s = clock_.now_s() + open_patience_s;
        if (!std::exchange(told, true))
          notes_.waits(
              FixedText<120>("waiting up to {:g} s until the server has opened its bus", Remote::bus_patience_s)
                  .view());
      }
      if (clock_.now_s() >= until_s) throw failure(spec.argument + " does not answer in time");
      wait();
      advance();
    }
  }

  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    const Pattern& pattern = fresh_ ? newest_ : loading_;
    const bool patterned = !pattern.empty() && slot < pattern.until_slot();
    if (!session::sounds(drive)) {
      silence();
    } else if (patterned) {
      if (std::exchange(sounding_, true) == false && !fresh_) place_ = 0;  // a silenced pattern is sent again
      allow_start(pattern);
      tally_.play();
    } else {
      std::transform(drive.begin(), drive.end(), drive_.begin(), emission);
      sounding_ = drive_waits_ = true;
      ++drives_.given;
    }
    advance();
  }

  void plan(const BoardPlan& plan) override {
    ++plans_.given;
    drive_waits_ = false;
    if (!plan.slots.cycle.is_listed()) {
      if (plan.slots.cycle.plays == session::Plays::nothing) silence();
      fresh_ = false;
      place_ = 0;
      newest_.clear();
      loading_.clear();
      return;
    }
    newest_.encode(plan);
    fresh_ = sounding_ = true;
    allow_start(newest_);
    advance();
  }

  /// Silences both pattern memories: nothing that a device could switch to sounds afterwards.
  void all_off() override {
    silence();
    wipes_ = true;
    advance();
  }

  void tend() override { advance(); }
  BoardCounts counts() const override { return tally_.counts(lost_); }

  std::span<const pollfd> watched() override {
    if (remote_.closed()) return {};
    watched_ = remote_.watched();
    return {&watched_, 1};
  }

  bool close() override {
    const double until_s = clock_.now_s() + close_patience_s;
    retry_at_s_ = 0;
    while (!silent_ || (wipes_ && !all_silent_) || !remote_.idle()) {
      if (clock_.now_s() >= until_s) return false;
      wait();
      advance();
    }
    tell(plans_, "plans");
    tell(drives_, "drives");
    remote_.say_goodbye(clock_.now_s());
    while (!remote_.closed() && clock_.now_s() < until_s) {
      wait();
      remote_.pump(clock_.now_s());
    }
    return true;
  }

 private:
  /// The steps of a start-up, in order. Only messages that are sent for their answers wait.
  enum Stage : int {
    first_message,  // its id may be that of the last message, and is then ignored
    clear_and_sync,
    cpu_major,
    fpga_major,
    versions_done,
    silencer,
    zeros,
    started
  };
  enum class Sent { nothing, startup, silence, modulation, part, gain };

  bool ready() const { return stage_ == started && remote_.idle(); }

  void wait() { clock_.wait_s(5e-3, remote_.watched()); }

  /// Allows for the time that the messages of a plan take before its first drive is heard.
  void allow_start(const Pattern& pattern) {
    constexpr double message_s = 2e-3;
    constexpr std::uint32_t beside = 3;  // the message on its way, a silence, a modulation
    if (pattern.slot_s() > 0)
      tally_.allow(static_cast<std::uint64_t>(std::ceil((pattern.parts() + beside) * message_s / pattern.slot_s())));
  }

  void silence() {
    tally_.gone();
    sounding_ = false;
    drive_waits_ = false;
    place_ = 0;    // nothing sounds of a pattern that was being sent
    if (fresh_) {  // the newest pattern is sent again
      std::swap(loading_, newest_);
      fresh_ = false;
    }
  }

  /// Continues with what waits, until the devices have to answer.
  void advance() {
    while (true) {
      const double now_s = clock_.now_s();
      if (remote_.closed()) {
        if (stage_ != started && !lost_) return;  // open() says why
        if (now_s < retry_at_s_) return;
        retry_at_s_ = now_s + retry_s;
        remote_.connect(now_s);
      }
      const Remote::Progress progress = remote_.pump(now_s);
      if (progress == Remote::Progress::failed) return lose(now_s);
      if (progress == Remote::Progress::done && !acknowledge()) return lose(now_s);
      if (!remote_.idle()) return;
      if (!send_next()) return;
      remote_.send(now_s);
    }
  }

  void lose(double now_s) {
    const bool opening = stage_ != started && !lost_;
    const bool first = !opening && !lost_;  // tried again at once, because it may still sound
    stage_ = first_message;
    sent_ = Sent::nothing;
    silent_ = all_silent_ = false;
    tally_.lost();
    place_ = 0;
    retry_at_s_ = first ? now_s : now_s + retry_s;
    if (first) {
      lost_ = true;
      notes_.warning(remote_.fault());
    }
  }

  /// Call when the last message has been acknowledged. Returns false if it cannot be played with these devices.
  bool acknowledge() {
    const Sent sent = std::exchange(sent_, Sent::nothing);
    const bool was_silent = silent_;
    silent_ = silent_ && sent == Sent::nothing;
    all_silent_ = all_silent_ && silent_;
    switch (sent) {
      case Sent::nothing:
        break;
      case Sent::startup:
        return acknowledge_startup();
      case Sent::silence:
      case Sent::gain:
        if (sent == Sent::gain) {
          drives_.end(clock_.now_s());
          tally_.drive_there();
        }
        segment_ ^= 1;
        silent_ = sent == Sent::silence;
        if (silent_) tally_.gone();
        all_silent_ = silent_ && was_silent;  // this silence went into the other memory
        break;
      case Sent::modulation:
        modulation_segment_ ^= 1;
        break;
      case Sent::part:
        if (transition_) {
          segment_ ^= 1;
          plans_.end(clock_.now_s());
          tally_.there();
        }
        break;
    }
    return true;
  }

  bool acknowledge_startup() {
    if (stage_ == cpu_major || stage_ == fpga_major) {
      for (std::size_t d = 0; d < remote_.devices(); ++d) {
        if (remote_.data(d) != known_firmware) {
          remote_.refuse(FixedText<120>("device {} has firmware 0x{:02x}; palpa needs 0x{:02x}, which is 12.1", d,
                                        remote_.data(d), known_firmware)
                             .view());
          return false;
        }
      }
    }
    if (stage_ == clear_and_sync) {
      segment_ = modulation_segment_ = 0;
      modulated_hz_ = 0;
    }
    if (stage_ == zeros) {
      segment_ ^= 1;
      silent_ = all_silent_ = true;  // they were cleared before
      if (std::exchange(lost_, false)) notes_.warning("the server is back");
    }
    stage_ = static_cast<Stage>(stage_ + 1);
    return true;
  }

  template <typename Put>
  void to_all(const Put& put) {
    for (std::size_t d = 0; d < remote_.devices(); ++d)
      put(remote_.message(d), d * transducers);
  }

  /// Writes the next message for all devices. Returns false if there is none.
  bool send_next() {
    if (stage_ != started) return send_startup();
    if (!sounding_) {
      if (silent_ && (all_silent_ || !wipes_)) return false;
      to_all([&](Message m, std::size_t) { put_silence(m, segment_ ^ 1); });
      sent_ = Sent::silence;
      return true;
    }
    wipes_ = false;
    const bool between = place_ == 0 || place_ == loading_.parts();
    if (fresh_ && between) {
      std::swap(loading_, newest_);
      fresh_ = false;
      place_ = 0;
    }
    if (!loading_.empty() && place_ < loading_.parts()) return send_part();
    if (!drive_waits_) return false;
    if (modulated_hz_ != 0) return send_modulation(0);
    drive_waits_ = false;
    drives_.begin(clock_.now_s());
    tally_.drive_sent();
    to_all([&](Message m, std::size_t first) {
      put_gain(m, segment_ ^ 1, std::span(drive_).subspan(first, transducers));
    });
    sent_ = Sent::gain;
    return true;
  }

  bool send_startup() {
    to_all([&](Message m, std::size_t) {
      switch (stage_) {
        case first_message:
          put_nop(m);
          break;
        case clear_and_sync:
          put_clear_and_sync(m);
          break;
        case cpu_major:
          put_version(m, Version::cpu_major);
          break;
        case fpga_major:
          put_version(m, Version::fpga_major);
          break;
        case versions_done:
          put_version(m, Version::done);
          break;
        case silencer:
          put_silencer(m, static_cast<std::uint16_t>(changes_.amplitude_steps),
                       static_cast<std::uint16_t>(changes_.phase_steps));
          break;
        default:
          put_silence(m, segment_ ^ 1);
          break;
      }
    });
    sent_ = Sent::startup;
    return true;
  }

  bool send_modulation(double hz) {
    const ModulationSamples samples =
        modulation_samples(hz, loading_.modulation(), loading_.begin_s(), clock_.day_at_zero_s(), clock_.now_s());
    to_all([&](Message m, std::size_t) {
      put_modulation(m, modulation_segment_ ^ 1, samples.divider, std::span(samples.samples).first(samples.count));
    });
    modulated_hz_ = hz;
    modulation_ = loading_.modulation();
    sent_ = Sent::modulation;
    return true;
  }

  bool send_part() {
    const double hz = loading_.modulation_hz();
    if (hz != modulated_hz_ || (hz != 0 && loading_.modulation() != modulation_)) return send_modulation(hz);
    const std::uint32_t parts = loading_.parts();
    if (place_ == 0) {
      plans_.begin(clock_.now_s());
      turn_.follow(loading_.begin_s(), loading_.slot_s(), clock_.day_at_zero_s());
    }
    const auto emissions = [&](std::uint32_t place, std::size_t first) {
      return loading_.part(turn_.part_at(place, parts)).subspan(first, transducers);
    };
    const std::uint8_t idle = segment_ ^ 1;
    if (place_ == 0 && can_be_foci()) {
      to_all([&](Message m, std::size_t first) { put_all_foci(m, first / transducers, idle); });
      place_ = parts;
      transition_ = true;
      tally_.sent();
      sent_ = Sent::part;
      return true;
    }
    const bool pairs = loading_.full() && parts > 1;
    const std::uint32_t sends = pairs && place_ + 1 < parts ? 2 : 1;
    const PatternStep step{idle, divider_, place_ == 0, place_ + sends == parts};
    to_all([&](Message m, std::size_t first) {
      if (parts == 1) {
        put_gain(m, idle, emissions(0, first));
      } else if (pairs) {
        put_pattern_phases(m, step, emissions(place_, first),
                           sends == 2 ? emissions(place_ + 1, first) : std::span<const Emission>());
      } else {
        put_pattern(m, step, emissions(place_, first));
      }
    });
    place_ += sends;
    transition_ = place_ == parts;
    if (transition_) tally_.sent();
    sent_ = Sent::part;
    return true;
  }

  FixedPoint fixed(const Vec3& focus, std::size_t device) const {
    const array::Board& board = layout_.boards[device];
    const Vec3 way = focus - layout_.transducers[board.first].position;
    const auto along = [&](int axis) {
      const double units = glm::dot(way, Vec3(board.T_layout_board[axis])) / fixed_unit_m;
      return static_cast<std::int32_t>(std::lround(std::clamp(units, -1e9, 1e9)));
    };
    return {along(0), along(1), along(2)};
  }

  /// Whether the devices can compute the drives from their foci: one amplitude for each drive, and foci within reach.
  bool can_be_foci() const {
    const std::span<const Vec3> foci = loading_.foci();
    if (!loading_.even() || foci.size() < 2 || foci.size() > most_foci) return false;
    if (sound_speed_m_s_ > most_sound_speed_m_s) return false;
    // Devices get the speed in steps, which matter if it is low and the way long.
    constexpr double most_turns_off = 2.0 / 256;
    const double told_m_s = std::round(sound_speed_m_s_ * sound_speed_steps) / sound_speed_steps;
    const double off_turns_per_m = std::abs(1 / told_m_s - 1 / sound_speed_m_s_) * period_hz;
    return std::ranges::all_of(foci, [&](const Vec3& focus) {
      for (std::size_t d = 0; d < remote_.devices(); ++d) {
        const double way = glm::length(focus - layout_.transducers[layout_.boards[d].first].position);
        if (!within_reach(fixed(focus, d)) || way * off_turns_per_m > most_turns_off) return false;
      }
      return true;
    });
  }
  void put_all_foci(Message message, std::size_t device, std::uint8_t segment) const {
    std::array<FixedPoint, most_foci> points;
    const std::uint32_t parts = loading_.parts();
    for (std::uint32_t place = 0; place < parts; ++place) {
      const std::uint32_t part = turn_.part_at(place, parts);
      points[place] = fixed(loading_.foci()[part], device);
      points[place].intensity = loading_.part(part)[0].intensity;
    }
    put_foci(message, segment, divider_, sound_speed_m_s_, std::span(points).first(parts));
  }

  /// How many were given, how many of them were completed, and how long those took.
  struct Rate {
    std::uint64_t given = 0, through = 0;
    double begun_s = 0, all_s = 0;
    void begin(double now_s) { begun_s = now_s; }
    void end(double now_s) {
      ++through;
      all_s += now_s - begun_s;
    }
  };
  void tell(const Rate& rate, const char* what) {
    if (rate.given == 0) return;
    const double each_s = rate.through == 0 ? 0.0 : rate.all_s / static_cast<double>(rate.through);
    notes_.info(
        FixedText<120>("{} of {} {} transferred, {:.1f} ms each", rate.through, rate.given, what, 1e3 * each_s).view());
  }

  BoardNotes& notes_;
  Clock& clock_;
  std::uint16_t divider_;   ///< periods of a slot
  array::Changes changes_;  ///< what its silencer does
  std::size_t count_;
  array::Layout layout_;
  double sound_speed_m_s_;
  Remote remote_;
  pollfd watched_{};

  // What should sound.
  bool sounding_ = false;
  bool fresh_ = false;  ///< newest_ has not been taken
  Pattern loading_, newest_;
  std::uint32_t place_ = 0;  ///< parts of loading_ that have been sent
  PartOffset turn_;
  std::vector<Emission> drive_;
  bool drive_waits_ = false;
  // What the devices do.
  Stage stage_ = first_message;
  Sent sent_ = Sent::nothing;
  bool transition_ = false;  ///< the sent message makes the other segment sound
  bool silent_ = false;
  bool all_silent_ = false, wipes_ = false;            ///< also what they could switch to; that is requested
  std::uint8_t segment_ = 0, modulation_segment_ = 0;  ///< the segments that are heard
  double modulated_hz_ = 0;
  array::Modulation modulation_ = array::Modulation::pressure_sine;
  bool lost_ = false;
  double retry_at_s_ = 0;
  Rate plans_, drives_;  ///< drives_: those that no plan has
  PlanTally tally_;
};

}  // namespace

std::unique_ptr<Board> open_board(const BoardSpec& spec, BoardNotes& notes, const Address& address, Clock& clock) {
  check(spec.layout);
  return std::make_unique<Autd3Board>(spec, notes, address, clock);
}

BoardKind board_kind() {
  BoardKind kind{"autd3", "autd3:HOST:PORT: AUTD3 units behind a server of the Remote protocol",
                 [](const BoardSpec& spec, BoardNotes& notes) {
                   check(spec.layout);
                   return open_board(spec, notes, resolve(spec.argument), steady_clock());
                 },
                 true};
  kind.own_layout = [](const std::string&) { return std::string("autd3"); };
  return kind;
}

}  // namespace palpa::driver::autd3
