#include "session/plan/device_drives.hpp"

#include <complex>
#include <cstring>

#include "base/error.hpp"
#include "touch/pass_watch.hpp"
#include "touch/types.hpp"

namespace palpa::session {
namespace {

constexpr std::uint32_t most_passes = 4;

}  // namespace

DeviceDrives::DeviceDrives(const gpu::Device& device, const SessionSetting& setting, const array::DrivePasses& passes,
                           array::Loudness* loudness)
    : passes_(passes),
      loudness_(loudness),
      memory_(device, setting.layout, setting.drive, most_cycle, most_cycle * touch::max_fingers),
      recorder_(device, "drives"),
      times_(device, most_passes),
      timeline_(device, "drives") {
  read_times_.reserve(most_passes);
}

bool DeviceDrives::start(Plan& plan, SlotWork& work, std::vector<gpu::PassTime>& times) {
  touch::PassWatch watch(times);
  memory_.clear();
  plan_slots(plan, work, loudness_, [&](const auto& foci, const auto& factors) {
    const bool fits = factors.empty() ? memory_.add_slot(foci) : memory_.add_slot(foci, factors);
    if (!fits) throw failure("a frame has more foci than its buffers hold");
  });
  if (loudness_) watch.mark("pressures");
  if (!plan.cycle.is_listed()) return false;
  submit();
  touch::PassWatch host_watch(times);
  memory_.solve_on_host();
  if (memory_.host_slots() > 0) host_watch.mark("drives on the host");
  return true;
}

void DeviceDrives::submit() {
  const VkCommandBuffer commands = recorder_.begin();
  times_.begin(commands);
  memory_.record(commands, passes_);
  times_.mark(commands, "drives");
  timeline_.submit(recorder_.end());
}

void DeviceDrives::finish(Plan& plan, std::vector<gpu::PassTime>& times) {
  timeline_.wait(timeline_.last());
  const std::size_t transducers = memory_.transducers();
  plan.drives.resize(plan.listed() * transducers);
  for (std::uint32_t slot = 0; slot < plan.listed(); ++slot) {
    const auto drive = memory_.drive(slot);
    std::memcpy(plan.drives.data() + slot * transducers, drive.data(), drive.size_bytes());
  }
  times_.read(read_times_);
  times.insert(times.end(), read_times_.begin(), read_times_.end());
}

/// Slots of one focus, of two, and so on up to the maximum that sounds together, because the kernels depend on this
/// number.
void DeviceDrives::warm_up(SlotWork& work) {
  std::vector<array::SlotFocus>& foci = work.foci;
  const auto dispatch = [&] {
    submit();
    memory_.solve_on_host();
    timeline_.wait(timeline_.last());
  };
  memory_.clear();
  foci.clear();
  for (std::uint32_t count = 1; count <= touch::max_foci; count *= 2) {
    while (foci.size() < count)
      foci.push_back({.position = {30e-3 * static_cast<double>(foci.size()), 0, 0}});
    if (!memory_.add_slot(foci)) break;
  }
  dispatch();
  if (!loudness_) return;
  memory_.clear();
  foci.resize(2);
  const std::complex<double> factors[2] = {};
  if (memory_.add_slot(foci, factors)) dispatch();
}

}  // namespace palpa::session
