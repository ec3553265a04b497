// The drives of a frame's plan, computed on a device.
#pragma once

#include <vector>

#include "array/drive_pass.hpp"
#include "array/loudness.hpp"
#include "gpu/commands.hpp"
#include "gpu/device.hpp"
#include "gpu/pass_time.hpp"
#include "gpu/timestamps.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// One object for each frame in flight.
class DeviceDrives {
 public:
  /// All must outlive it. The setting's layout has transducers. `loudness`: null if no finger requests a pressure.
  DeviceDrives(const gpu::Device& device, const SessionSetting& setting, const array::DrivePasses& passes,
               array::Loudness* loudness);

  /// Fills the cycle of a plan that has its schedule, and starts to compute the drives that it lists. Adds the time of
  /// the host's part to `times`. Returns whether there are any drives to wait for.
  bool start(Plan& plan, SlotWork& work, std::vector<gpu::PassTime>& times);
  /// Waits for the drives of the plan that was started, and adds their time to `times`.
  void finish(Plan& plan, std::vector<gpu::PassTime>& times);
  /// Dispatches all kernels once, because drivers compile a kernel when it is first dispatched.
  void warm_up(SlotWork& work);

 private:
  void submit();

  const array::DrivePasses& passes_;
  array::Loudness* loudness_;
  array::DriveMemory memory_;
  gpu::Recorder recorder_;
  gpu::Timestamps times_;
  std::vector<gpu::PassTime> read_times_;
  gpu::Timeline timeline_;
};

}  // namespace palpa::session
