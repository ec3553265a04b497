#include "session/chain.hpp"

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
  touch.fingers.resize(touch::max_fingers);
  for (touch::Finger& finger : touch.fingers) {
    finger.contacts.reserve(contacts_per_finger);
    finger.foci.reserve(touch::max_foci);
  }
}

void make_schedule(const touch::Touch& touch, std::span<const std::uint32_t> ids, double time_s,
                   const ChainSetting& setting, array::Schedule& schedule) {
  schedule.clear();
  schedule.slot_s = setting.slot_s;
  schedule.time_s = time_s;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    array::make_voice(touch.fingers[f], ids[f], setting.voice, schedule.add_voice());
  }
}

}  // namespace palpa::session
