#include "session/planner.hpp"

namespace palpa::session {

void reserve(touch::Touch& touch) {
  touch.contacts.reserve(touch::max_fingers * contacts_per_finger);
  touch.deep.reserve(most_deep);
  touch.fingers.resize(touch::max_fingers);
  for (touch::Finger& finger : touch.fingers) {
    finger.contacts.reserve(contacts_per_finger);
    finger.foci.reserve(touch::max_foci);
  }
}

touch::StageSetting stage_setting(const SessionSetting& setting) {
  return {.parameters = setting.touch,
          .follow = setting.follow,
          .axes = setting.axes,
          .smoothing = setting.smoothing,
          .memory_s = setting.hold_s};
}

}  // namespace palpa::session
