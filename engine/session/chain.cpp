#include "session/chain.hpp"

#include "session/overrides.hpp"
#include "session/voice.hpp"

namespace palpa::session {

static_assert(acoustics::StrideTuner::most_fingers >= touch::max_fingers);
static_assert(acoustics::most_ring_foci >= touch::max_foci);

void reserve(touch::Touch& touch) {
  touch.contacts.reserve(touch::max_fingers * contacts_per_finger);
  touch.deep.reserve(most_deep);
  touch.fingers.resize(touch::max_fingers);
  for (touch::Finger& finger : touch.fingers) {
    finger.contacts.reserve(contacts_per_finger);
    finger.foci.reserve(touch::max_foci);
  }
}

void reserve(ScheduleMemory& memory) {
  memory.placement.foci.reserve(touch::max_foci);
}

void make_schedule(const touch::Touch& touch, double time_s, std::span<const geometry::Solid> solids,
                   const ScheduleOptions& options, double slot_s, ScheduleMemory& memory, array::Schedule& schedule) {
  schedule.clear();
  schedule.slot_s = slot_s;
  schedule.time_s = time_s;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const touch::Placement& placement = memory.placement;
    touch::place_foci(touch, finger, options.method, memory.placement);
    array::VoiceOptions voice = voice_on(solids[finger.solid], options.voice);
    if (options.tune && !placement.still()) {
      const auto foci = static_cast<std::uint32_t>(placement.foci.size());
      const acoustics::Ring ring{touch::perimeter_of(placement), foci, voice.stride, voice.dwell_s};
      voice.stride = memory.strides.stride_for(finger.id, ring, time_s);
    }
    make_voice(placement, finger.id, finger.solid, voice, schedule.add_voice());
  }
}

}  // namespace palpa::session
