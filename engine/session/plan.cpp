#include "session/plan.hpp"

#include "touch/types.hpp"

namespace palpa::session {

void reserve(array::Schedule& schedule) {
  schedule.voices.resize(touch::max_fingers);
  for (array::Voice& voice : schedule.voices) {
    voice.foci.reserve(touch::max_foci);
    voice.order.reserve(touch::max_foci);
  }
}

void reserve(Plan& plan, std::size_t transducers) {
  reserve(plan.schedule);
  plan.drives.reserve(most_cycle * transducers);
}

ToldPlan told(const Plan& plan, std::size_t transducers, std::uint64_t from_slot, std::uint64_t until_slot) {
  return {.schedule = plan.schedule,
          .from_slot = from_slot,
          .until_slot = until_slot,
          .cycle = plan.cycle,
          .drives = std::span(plan.drives).first(plan.cycle * transducers),
          .shared_modulation_hz = plan.shared_modulation_hz,
          .shared_modulation = plan.shared_modulation};
}

}  // namespace palpa::session
