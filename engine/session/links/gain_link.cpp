#include "session/links/gain_link.hpp"

#include <utility>

#include "session/links/plan.hpp"

namespace palpa::session {

GainLink::GainLink(std::unique_ptr<Link> link, const std::atomic<double>& gain) : link_(std::move(link)), gain_(gain) {}

void GainLink::plan(const PlayedPlan& plan) {
  const double gain = gain_;
  if (gain == 1) return link_->plan(plan);
  schedule_ = plan.schedule;
  scale(schedule_, gain);
  drives_.assign(plan.drives.begin(), plan.drives.end());
  scale(drives_, gain);
  link_->plan({.schedule = schedule_, .slots = plan.slots, .drives = drives_});
}

void GainLink::send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) {
  const double gain = gain_;
  if (gain == 1) return link_->send(slot, drive);
  drives_.assign(drive.begin(), drive.end());
  scale(drives_, gain);
  link_->send(slot, drives_);
}

}  // namespace palpa::session
