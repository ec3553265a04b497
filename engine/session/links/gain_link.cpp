#include "session/links/gain_link.hpp"

#include <utility>

#include "array/schedule.hpp"

namespace palpa::session {
namespace {

void multiply(std::span<const array::TransducerDrive> from, double gain, array::Drive& to) {
  to.assign(from.begin(), from.end());
  for (array::TransducerDrive& transducer : to)
    transducer.amplitude = static_cast<float>(transducer.amplitude * gain);
}

}  // namespace

GainLink::GainLink(std::unique_ptr<Link> link, const std::atomic<double>& gain) : link_(std::move(link)), gain_(gain) {}

void GainLink::plan(const PlayedPlan& plan) {
  const double gain = gain_;
  if (gain == 1) return link_->plan(plan);
  schedule_ = plan.schedule;
  for (std::uint32_t v = 0; v < schedule_.voice_count; ++v) {
    array::Voice& voice = schedule_.voices[v];
    voice.gain *= gain;
    voice.target_pa *= gain;
    if (voice.reached_pa) *voice.reached_pa *= gain;
  }
  multiply(plan.drives, gain, drives_);
  link_->plan({.schedule = schedule_, .slots = plan.slots, .drives = drives_});
}

void GainLink::send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) {
  const double gain = gain_;
  if (gain == 1) return link_->send(slot, drive);
  multiply(drive, gain, drives_);
  link_->send(slot, drives_);
}

}  // namespace palpa::session
