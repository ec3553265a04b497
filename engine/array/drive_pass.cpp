#include "array/drive_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "spirv/drive_focus.comp.hpp"
#include "spirv/drive_sum.comp.hpp"

namespace palpa::array {

static_assert(sizeof(TransducerDrive) == sizeof(shader::DriveOut) &&
              offsetof(TransducerDrive, phase) == offsetof(shader::DriveOut, phase));
static_assert(static_cast<std::uint32_t>(Weighting::distance) == shader::drive_by_distance);
static_assert(static_cast<std::uint32_t>(Weighting::uniform) == shader::drive_by_nothing);
static_assert(static_cast<std::uint32_t>(Constraint::normalise) == shader::drive_normalise);
static_assert(static_cast<std::uint32_t>(Constraint::uniform) == shader::drive_uniform);
static_assert(static_cast<std::uint32_t>(Constraint::clamp) == shader::drive_clamp);

namespace {
constexpr std::uint32_t most_groups = 65535;
}

DrivesPass::DrivesPass(const gpu::Device& device)
    : focus_(device, "drive_focus", spirv::drive_focus_comp, {shader::drive_buffers, sizeof(shader::DrivePush)}),
      sum_(device, "drive_sum", spirv::drive_sum_comp, {shader::drive_buffers, sizeof(shader::DrivePush)}) {}

void DrivesPass::record(VkCommandBuffer commands, const DriveRefs& refs, const DriveBatch& batch) const {
  const shader::DrivePush push{batch.transducers, batch.slots, static_cast<std::uint32_t>(batch.weighting),
                               static_cast<std::uint32_t>(batch.constraint)};
  if (batch.single) {
    focus_.dispatch(commands, {refs.transducers, refs.foci, refs.slots, refs.drives}, &push,
                    gpu::groups_for(batch.transducers, shader::drive_group * shader::drive_each),
                    gpu::groups_for(batch.slots, shader::drive_slots_per_group));
  }
  // They write different slots, but of one buffer, which nothing else tells apart.
  if (batch.single && batch.several) gpu::compute_to_compute(commands);
  if (batch.several) {
    sum_.dispatch(commands, {refs.transducers, refs.foci, refs.slots, refs.drives}, &push,
                  batch.transducers == 0 ? 0 : batch.slots);
  }
}

shader::DrivePoint drive_point(const Vec3& metres, double turns_per_metre) {
  const Vec3 turns = metres * turns_per_metre;
  const Vec3 coarse = glm::floor(turns * 16.0 + 0.5) / 16.0;
  const Vec3 fine = turns - coarse;
  return {{static_cast<float>(coarse.x), static_cast<float>(coarse.y), static_cast<float>(coarse.z), 0},
          {static_cast<float>(fine.x), static_cast<float>(fine.y), static_cast<float>(fine.z), 0}};
}

std::uint32_t DriveBuffers::fitting_slots(const gpu::Device& device, std::size_t transducers) {
  const std::uint64_t bytes = std::max<std::uint64_t>(1, transducers) * sizeof(TransducerDrive);
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(most_groups, device.limits().maxStorageBufferRange / bytes));
}

DriveBuffers::DriveBuffers(const gpu::Device& device, const Layout& layout, const Medium& medium,
                           std::uint32_t most_slots, std::uint32_t most_foci)
    : turns_per_metre_(medium.turns_per_metre()), reach_(layout) {
  const std::uint32_t fitting = fitting_slots(device, layout.transducers.size());
  if (most_slots > fitting || layout.transducers.size() > max_transducers) {
    throw bad_usage(fmt::format("{} slots of {} transducers exceed what {} holds in one buffer: at most {} slots",
                                most_slots, layout.transducers.size(), device.description().name, fitting));
  }
  batch_.transducers = static_cast<std::uint32_t>(layout.transducers.size());
  transducers_ = gpu::Upload(device, batch_.transducers * sizeof(shader::DrivePoint), "drive transducers");
  // At least one: silent slots read an entry that they do not use.
  foci_ = gpu::Upload(device, std::max(1U, most_foci) * sizeof(shader::DriveFocus), "drive foci");
  slots_ = gpu::Upload(device, most_slots * sizeof(shader::DriveSlot), "drive slots");
  const std::uint64_t drives = std::uint64_t{most_slots} * batch_.transducers;
  drives_ = gpu::Readback(device, drives * sizeof(TransducerDrive), "drives");
  std::ranges::transform(layout.transducers, transducers_.as<shader::DrivePoint>().begin(),
                         [&](const Transducer& t) { return drive_point(t.position, turns_per_metre_); });
  clear();
}

void DriveBuffers::clear() {
  batch_.slots = 0;
  batch_.single = batch_.several = false;
  used_foci_ = 0;
}

bool DriveBuffers::add_slot(std::span<const SlotFocus> foci) {
  const auto slots = slots_.as<shader::DriveSlot>();
  const auto store = foci_.as<shader::DriveFocus>();
  const auto count = static_cast<std::size_t>(std::ranges::count_if(foci, drivable));
  if (batch_.slots == slots.size() || count > store.size() - used_foci_) return false;

  float shared = 0;
  for (const SlotFocus& focus : foci) {
    if (drivable(focus)) shared = std::max(shared, gain_of(focus));
  }
  slots[batch_.slots++] = {used_foci_, static_cast<std::uint32_t>(count), shared, 0};
  (count > 1 ? batch_.several : batch_.single) = true;
  for (const SlotFocus& focus : foci) {
    if (!drivable(focus)) continue;
    const shader::DrivePoint point = drive_point(focus.position, turns_per_metre_);
    shader::DriveFocus entry{point.coarse, point.fine};
    const double reach = reach_.farthest(focus.position) * turns_per_metre_;
    // Nearer than any float tells apart from 0: as if at the focus.
    entry.coarse.w = reach > 1e-6 ? static_cast<float>(1 / reach) : 0;
    entry.fine.w = shared > 0 ? gain_of(focus) / shared : 1;
    store[used_foci_++] = entry;
  }
  return true;
}

void DriveBuffers::record(VkCommandBuffer commands, const DrivesPass& pass, Weighting weighting,
                          Constraint constraint) {
  // The batch before wrote and read the same memory; see gpu/barrier.hpp.
  gpu::compute_to_compute(commands);
  if (!transducers_sent_) transducers_.record(commands);
  transducers_sent_ = true;
  foci_.record(commands, used_foci_ * sizeof(shader::DriveFocus));
  slots_.record(commands, batch_.slots * sizeof(shader::DriveSlot));
  batch_.weighting = weighting;
  batch_.constraint = constraint;
  pass.record(commands, {transducers_.ref(), foci_.ref(), slots_.ref(), drives_.ref()}, batch_);
  drives_.record(commands, std::uint64_t{batch_.slots} * batch_.transducers * sizeof(TransducerDrive));
}

std::span<const TransducerDrive> DriveBuffers::drive(std::uint32_t slot) const {
  return drives_.as<TransducerDrive>().subspan(std::size_t{slot} * batch_.transducers, batch_.transducers);
}

}  // namespace palpa::array
