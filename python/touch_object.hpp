// A touch as a Python object, of a Scene or of a Session's frame.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/tasks/touch.hpp"
#include "touch/types.hpp"

namespace palpa::python {

/// `palpa.Touch`: a copy of what the engine found, which needs neither the session nor a device.
struct TouchObject {
  setup::TouchValues values;
  double time_s = 0;
  std::optional<std::string> unreached;
};

/// `palpa.Finger`, one of a touch, which it keeps alive.
struct FingerObject {
  std::shared_ptr<const TouchObject> whole;
  std::uint32_t index = 0;
  const setup::TouchValues& values() const { return whole->values; }
  const touch::Finger& finger() const { return values().touch.fingers[index]; }
  const session::ScheduledFinger& scheduled() const { return values().fingers[index]; }
  const array::Voice& voice() const { return values().schedule.voices[index]; }
};

/// `palpa.Contacts`: a view of a touch's contacts.
struct ContactsObject {
  std::shared_ptr<const TouchObject> whole;
  const std::vector<touch::Contact>& all() const { return whole->values.touch.contacts; }
};

}  // namespace palpa::python
