// How loud the drives of a plan are to the ear (acoustics/audible.hpp): as the layout's boards play them, with their
// amplitudes and their way from drive to drive.
#pragma once

#include <cstddef>

#include "acoustics/audible.hpp"
#include "array/layouts/changes.hpp"
#include "array/transducer_drive.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// The drives of so many slots that they repeat, if they do so soon enough.
struct EarDrives {
  array::Drive drives;  ///< none: nothing sounds
  std::size_t transducers = 0;
  double slot_s = 1.5e-3;
  array::Changes changes;
  acoustics::EarOptions ear;

  acoustics::PlayedDrives played() const { return {drives, transducers, slot_s, changes}; }
};

/// At the setting's ceiling. `steps`: --steps of boards that can, all of them on one USB bus.
EarDrives ear_drives(const Plan& plan, const SessionSetting& setting, bool steps);

}  // namespace palpa::session
