#include "session/chain.hpp"

#include "session/overrides.hpp"

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

void reserve(touch::Touch& touch) {
  touch.contacts.reserve(touch::max_fingers * contacts_per_finger);
  touch.deep.reserve(most_deep);
  touch.fingers.resize(touch::max_fingers);
  for (touch::Finger& finger : touch.fingers) {
    finger.contacts.reserve(contacts_per_finger);
    finger.foci.reserve(touch::max_foci);
  }
}

void make_schedule(const touch::Touch& touch, double time_s, std::span<const geometry::Solid> solids,
                   const array::VoiceOptions& voice, double slot_s, array::Schedule& schedule) {
  schedule.clear();
  schedule.slot_s = slot_s;
  schedule.time_s = time_s;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    array::make_voice(finger, finger.id, voice_on(solids[finger.solid], voice), schedule.add_voice());
  }
}

}  // namespace palpa::session
