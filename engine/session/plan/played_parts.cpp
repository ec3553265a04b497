#include "session/plan/played_parts.hpp"

#include <algorithm>

namespace palpa::session {

const array::Schedule& PlayedParts::correct(const Plan& plan) {
  schedule_ = plan.schedule;
  const double ceiling = ceiling_of(safety_);
  if (!plan.cycle.is_listed() || plan.cycle.length == 0 || !(ceiling > 0)) return schedule_;
  const std::size_t transducers = plan.drives.size() / plan.listed();
  const std::uint64_t slot = calls_++ % plan.cycle.length;
  const std::span<const array::TransducerDrive> drive = plan.drive(slot, transducers);
  drive_.assign(drive.begin(), drive.end());
  for (array::TransducerDrive& one : drive_)
    one.amplitude *= static_cast<float>(ceiling);
  array::foci_of_slot(schedule_, slot, foci_);
  requested_.round(drive_, foci_, ceiling, ceiling);
  // The weakest focus of a voice counts.
  weakest_.assign(schedule_.voice_count, 1);
  heard_.assign(schedule_.voice_count, false);
  for (const array::RequestedPlay::Part& part : requested_.parts()) {
    if (!part.at_crest) continue;
    weakest_[part.voice] = heard_[part.voice] ? std::min(weakest_[part.voice], part.played) : part.played;
    heard_[part.voice] = true;
  }
  for (std::uint32_t v = 0; v < schedule_.voice_count; ++v) {
    if (schedule_.voices[v].reached_pa) *schedule_.voices[v].reached_pa *= weakest_[v];
  }
  return schedule_;
}

}  // namespace palpa::session
