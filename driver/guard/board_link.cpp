#include "driver/guard/board_link.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/system/now.hpp"
#include "base/system/real_time.hpp"
#include "driver/guard/guard.hpp"
#include "driver/guard/patience.hpp"
#include "driver/guard/process.hpp"
#include "session/links/board_sound.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/real_time_service.hpp"
#include "session/links/slots.hpp"

namespace palpa::driver {
namespace {

using session::BoardSound;

constexpr double open_s = 10;       // a board that was left in an unknown state takes seconds to come back
constexpr double slow_open_s = 40;  // if the guard has said that it waits for a bus
constexpr double exit_s = 1;
constexpr double most_slot_s = heartbeat_s / 2;  // a longer slot would be silenced between two drives

class BoardLink final : public session::Link {
 public:
  BoardLink(Brief brief, std::string program, bool plays_plans, bool free_field)
      : brief_(std::move(brief)),
        program_(std::move(program)),
        plays_plans_(plays_plans),
        free_field_(free_field),
        guard_(std::in_place, program_, brief_, plays_plans ? session::most_cycle : 0) {
    wait_until_open();
    is(BoardSound::silent);
    // The guard has no library for this. With it, it goes before the thread that feeds it.
    const RealTimeService service = session::real_time_service();
    if (service && scheduling_of(guard_->id()) != Scheduling::real_time && has_time_for_real_time(guard_->id()))
      service(guard_->id(), guard_->id(), guard_priority);
  }

  void plan(const session::PlayedPlan& plan) override {
    if (!guard_) return;
    is(BoardSound::unknown);
    TimedSlots timed{plan.slots, monotonic_s(), plan.schedule.slot_s};
    until_s_ = timed.until_s();
    if (!plays_plans_) return;
    const auto place = guard_->memory().plan(plan_place_);
    if (plan.drives.size() > place.drives.size()) {
      throw failure(fmt::format("{}: a plan has {} drives; at most {} are possible", brief_.kind,
                                plan.slots.cycle.length, session::most_cycle));
    }
    if (plan.schedule.voice_count == 0) timed.slots.cycle = {};  // silence ends all else
    const std::span<const Vec3> foci = free_field_ ? plan.foci : std::span<const Vec3>();
    place.head = {timed, static_cast<std::uint32_t>(foci.size())};
    std::copy(plan.drives.begin(), plan.drives.end(), place.drives.begin());
    std::copy_n(foci.begin(), std::min(foci.size(), place.foci.size()), place.foci.begin());
    planned_ = timed.slots;
    plan_place_ = guard_->memory().plan_buffer().commit(plan_place_).place;
  }

  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override { send(slot, drive, false); }
  void send_planned(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    send(slot, drive, planned_.cycle.is_listed() && slot >= planned_.from && slot < planned_.until);
  }
  bool plays_plans() const override { return plays_plans_; }
  const array::Layout* boards() const override { return &brief_.board.layout; }

  void finish() override {
    if (!guard_) return;
    const Scheduling scheduling = scheduling_of(guard_->id());
    told();
    guard_->hang_up();
    guard_->wake();
    const double until_s = monotonic_s() + exit_s;
    while (guard_->wait_for_word(until_s - monotonic_s()) && listen()) {
    }
    const bool ended = guard_->wait_for_exit(std::max(until_s - monotonic_s(), 0.0)).ended;
    carried_ = guard_->memory().tally().read();
    carried_.guard_scheduling = scheduling;
    if (ended && last_word_ == MessageKind::opened) end_without_guard();
    told();
    guard_.reset();
    if (!ended) fail("after 1 s, palpa-guard is still trying to silence the board");
    if (last_word_ == MessageKind::unsure) fail("palpa-guard could not make sure that the last silence arrives");
    is(BoardSound::silent);
  }

  std::optional<session::Carried> carried() const override {
    if (!guard_) return carried_;
    session::Carried counts = guard_->memory().tally().read();
    counts.guard_scheduling = scheduling_of(guard_->id());
    return counts;
  }

 private:
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive, bool is_in_pattern) {
    if (!guard_) return;
    is(BoardSound::unknown);
    const auto place = guard_->memory().drive(drive_place_);
    if (drive.size() != place.drives.size())
      throw failure(fmt::format("{}: a drive has {} transducers; the layout has {}", brief_.kind, drive.size(),
                                place.drives.size()));
    place.head = {slot, until_s_, is_in_pattern ? 1U : 0U};
    std::copy(drive.begin(), drive.end(), place.drives.begin());
    const TripleBuffer::Committed committed = guard_->memory().drive_buffer().commit(drive_place_);
    drive_place_ = committed.place;
    const bool there = send_message(guard_->socket(), MessageKind::drive);
    if (!listen() || !there || hangs(committed.unread)) end_without_guard();
  }

  /// Whether the guard has taken nothing for too long. If so, kills it.
  bool hangs(bool unread) {
    if (!patience_.ends(unread, monotonic_s())) return false;
    guard_->kill();
    hung_ = true;
    return true;
  }

  void is(BoardSound sound) {
    if (sound_ == nullptr) sound_ = &session::board_sound(name_);
    *sound_ = sound;
  }
  /// It was told to be silent, and has not answered yet.
  void told() { is(guard_->memory().tally().read().out_of_reach ? BoardSound::gone : BoardSound::told); }
  [[noreturn]] void fail(const std::string& what) const {
    throw failure(fmt::format("{}: {}; {}", brief_.kind, what, session::to_text(name_, *sound_)));
  }

  void wait_until_open() {
    const double began_s = monotonic_s();
    while (last_word_ != MessageKind::opened) {
      const double most_s = opens_slowly_ ? slow_open_s : open_s;
      if (!guard_->wait_for_word(began_s + most_s - monotonic_s()))
        throw failure(fmt::format("{}: the board is not open after {} s", brief_.kind, most_s));
      if (!listen()) end_without_guard();
    }
  }

  /// Takes the guard's messages. Returns false if the guard is gone.
  bool listen() {
    std::array<char, Message::most + 1> buffer{};
    Message message{};
    while (true) {
      const Received received = receive_message(guard_->socket(), buffer, message);
      if (received == Received::gone) return false;
      if (received == Received::nothing) return true;
      switch (message.kind) {
        case MessageKind::warning:
          log::warning(fmt::format("{}: {}", brief_.kind, message.text));
          break;
        case MessageKind::waits:
          log::at_once(fmt::format("{}: {}", brief_.kind, message.text));
          opens_slowly_ = true;
          break;
        case MessageKind::info:
          log::info(fmt::format("{}: {}", brief_.kind, message.text));
          break;
        case MessageKind::refused:
          refuse(message.text);
        default:
          last_word_ = message.kind;
      }
    }
  }

  [[noreturn]] static void refuse(std::string_view text) {
    if (text.empty()) throw failure("palpa-guard refused without a reason");
    throw Error(static_cast<Exit>(text[0]), std::string(text.substr(1)));
  }

  std::string how_it_ended(const GuardProcess::Exit& exit) const {
    if (!exit.ended) return "palpa-guard does not answer";
    if (hung_) return fmt::format("palpa-guard took no drive for {} s", Patience::most_s);
    if (exit.by_signal != 0) return fmt::format("signal {} ended palpa-guard", exit.by_signal);
    return fmt::format("palpa-guard ended with exit code {}", exit.code);
  }

  [[noreturn]] void end_without_guard() {
    const GuardProcess::Exit exit = guard_->wait_for_exit(exit_s);
    carried_ = guard_->memory().tally().read();
    guard_.reset();
    if (last_word_ == MessageKind::asked_to_leave) {
      is(BoardSound::silent);
      fail("palpa-guard was asked to end (SIGTERM)");
    }
    const std::string what = how_it_ended(exit);
    is(silence_once_more() ? BoardSound::silent : BoardSound::unknown);
    fail(what + (*sound_ == BoardSound::silent ? ", and a second one was started" : ", and a second one failed"));
  }

  bool silence_once_more() {
    Brief brief = brief_;
    brief.only_silence = true;
    last_word_ = MessageKind::drive;
    try {
      guard_.emplace(program_, brief, 0);
      const double until_s = monotonic_s() + (opens_slowly_ ? slow_open_s : open_s);
      while (guard_->wait_for_word(until_s - monotonic_s()) && listen()) {
      }
    } catch (const Error& error) {
      log::warning(fmt::format("{}: {}", brief_.kind, error.what()));
    }
    guard_.reset();
    return last_word_ == MessageKind::silent;
  }

  Brief brief_;
  std::string name_ = brief_.kind + ":" + brief_.board.argument;
  std::atomic<BoardSound>* sound_ = nullptr;  ///< set as soon as something is known
  std::string program_;
  bool plays_plans_, free_field_;
  std::optional<GuardProcess> guard_;
  session::Carried carried_;                    ///< of a guard that is gone
  MessageKind last_word_ = MessageKind::drive;  ///< from the guard; none yet
  Patience patience_{brief_.board.slot_s, monotonic_s()};
  bool opens_slowly_ = false;
  bool hung_ = false;                                         ///< the guard, and was killed
  double until_s_ = std::numeric_limits<double>::infinity();  ///< the newest plan (or drives) may sound until then
  session::Slots planned_;                                    ///< of the newest plan, if the board plays plans
  std::uint32_t drive_place_ = TripleBuffer::writers_first, plan_place_ = TripleBuffer::writers_first;
};

}  // namespace

session::LinkKind board_link(const BoardKind& kind, const std::string& program) {
  return {kind.name,
          kind.help,
          [name = kind.name, plays_plans = kind.plays_plans, factors = kind.factors, program](
              const std::string& argument, const session::LinkSetting& setting) {
            if (setting.slot_s > most_slot_s)
              throw bad_usage(
                  fmt::format("link {}: a board is silenced {} ms after its last drive, so a dwell of {} ms is too "
                              "long: give at most {} ms",
                              name, 1e3 * heartbeat_s, 1e3 * setting.slot_s, 1e3 * most_slot_s));
            Brief brief{.kind = name,
                        .board = {.argument = argument,
                                  .files = setting.board_files,
                                  .layout = setting.layout,
                                  .slot_s = setting.slot_s,
                                  .foci_move = setting.foci_move,
                                  .sound_speed_m_s = setting.sound_speed_m_s,
                                  .ramp_s = setting.ramp_s,
                                  .steps = setting.steps,
                                  .nulls = setting.nulls}};
            if (factors) brief.board.layout.factors = factors(brief.board);
            return std::make_unique<BoardLink>(std::move(brief), program.empty() ? guard_program() : program,
                                               plays_plans, setting.free_field);
          },
          false,
          kind.reads_files,
          kind.own_layout,
          kind.least_moving_slot_s,
          kind.plays_plans,
          kind.takes_steps,
          kind.single_drive_s};
}

}  // namespace palpa::driver
