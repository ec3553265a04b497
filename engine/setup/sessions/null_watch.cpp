#include "setup/sessions/null_watch.hpp"

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <utility>

#include "array/drive.hpp"
#include "array/schedule.hpp"
#include "base/log.hpp"
#include "setup/options/nulls.hpp"

namespace palpa::setup {
namespace {

/// A ring has one focus in each slot, and rarely more foci than this.
constexpr std::uint32_t most_slots = 32;
/// Nearer to where they were, foci lose about as much.
constexpr double moved_m = 1e-3;

}  // namespace

void NullDoubts::tell(Kind kind, const std::string& line) {
  if (line.empty() || std::exchange(told_[kind], true)) return;
  log::warning("--null: " + line + "; this warning comes once");
}

void NullDoubts::look(const SlotFoci& slots) {
  Crowding worst{.part = -1};
  const std::vector<array::SlotFocus>* at = nullptr;
  for (const std::vector<array::SlotFocus>& foci : slots) {
    Crowding crowding = crowding_of(*layout_, foci, *options_, FocusNames::places);
    tell(within, crowding.within);
    if (crowding.part <= worst.part) continue;
    worst = std::move(crowding);
    at = &foci;
  }
  if (at == nullptr || worst.part <= seen_) return;
  seen_ = worst.part;
  tell(crowded, worst.line);
  const NullReport report =
      report_nulls(*layout_, array::drive_for(*layout_, *at, *options_), *at, *options_, FocusNames::places);
  tell(quiet, report.quiet);
  tell(loud, report.loud);
}

NullWatch::NullWatch(const array::Layout& layout, const array::DriveOptions& options, bool at_once)
    : doubts_(layout, options) {
  if (at_once) return;
  thread_ = std::make_unique<session::AnswerThread<SlotFoci, Answer>>(
      [this](const SlotFoci& slots, const std::atomic<bool>&) {
        doubts_.look(slots);
        return Answer{};
      });
}

void NullWatch::planned(const session::Plan& plan) {
  places_.clear();
  slots_.clear();
  std::vector<array::SlotFocus> foci;
  const auto same_place = [](const array::SlotFocus& a, const array::SlotFocus& b) { return a.position == b.position; };
  const std::uint32_t count = std::min(plan.cycle.slots_to_look_at(), most_slots);
  for (std::uint32_t slot = 0; slot < count; ++slot) {
    array::foci_of_slot(plan.schedule, slot, foci);
    std::erase_if(foci, [](const array::SlotFocus& focus) { return !(focus.gain > 0); });
    if (foci.empty() || (!slots_.empty() && std::ranges::equal(foci, slots_.back(), same_place))) continue;
    for (const array::SlotFocus& focus : foci)
      places_.push_back(focus.position);
    slots_.push_back(foci);
  }
  const auto stayed = [](const Vec3& a, const Vec3& b) { return glm::distance(a, b) < moved_m; };
  if (places_.empty() || std::ranges::equal(places_, seen_, stayed)) return;
  std::swap(places_, seen_);
  if (thread_) {
    thread_->ask(slots_);
  } else {
    doubts_.look(slots_);
  }
}

WatchedNulls::WatchedNulls(const session::SessionSetting& setting, session::RunObserver& next, bool at_once)
    : next_(next) {
  if (setting.drive.nulls) watch_.emplace(setting.layout, setting.drive, at_once);
}

void WatchedNulls::planned(const session::FrameReport& report, const session::Plan& plan) {
  if (watch_) watch_->planned(plan);
  next_.planned(report, plan);
}

void warn_of_boards(const std::string& link, const session::Session& session) {
  const session::SessionSetting& setting = session.setting();
  if (!setting.drive.nulls) return;
  double gain = 1;  // of the solid with the least
  for (const session::SolidHaptics& solid : session.scheduler().solids())
    gain = std::min(gain, solid.voice.gain);
  const std::string doubt =
      coarse_boards_line(link, setting.layout, setting.drive.constraint, setting.safety.ceiling * gain);
  if (!doubt.empty()) log::warning(doubt);
}

}  // namespace palpa::setup
