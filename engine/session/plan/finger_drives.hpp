// Drives from the sound on the fingers (`--transfer finger`).
#pragma once

#include <optional>
#include <span>

#include "array/drive.hpp"
#include "array/loudness.hpp"
#include "session/plan/finger_sounds.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/scheduler.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// Computes the drives of a frame on the host, from the sound on its fingers.
class FingerDrives {
 public:
  FingerDrives(const SessionSetting& setting, const Scheduler& scheduler, FingerSounds& sounds);
  /// Fills cycle and drives if the plan lists its slots, and if the sound is known at some of its foci. Otherwise
  /// returns false: all slots then sound as in free air.
  bool make(Plan& plan, SlotWork& work);

 private:
  void drive_one(const array::SlotFocus& focus, std::span<array::TransducerDrive> out);

  const array::Layout& layout_;
  FingerSounds& sounds_;
  array::DriveOptions in_free_air_, drive_;
  array::DriveScratch scratch_;
  std::optional<array::Loudness> loudness_;
};

}  // namespace palpa::session
