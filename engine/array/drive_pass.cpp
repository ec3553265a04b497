#include "array/drive_pass.hpp"
#include "array/pressures/solver_traits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "gpu/barrier.hpp"
#include "spirv/drive_focus.comp.hpp"
#include "spirv/drive_sum.comp.hpp"
#include "spirv/drive_weighted.comp.hpp"

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

gpu::TexelView floats(const gpu::Device& device, const gpu::BufferRef& buffer, const char* name) {
  return {device, buffer, VK_FORMAT_R32G32B32A32_SFLOAT, name};
}

}  // namespace

std::size_t most_pass_foci(std::uint32_t transducers) {
  constexpr std::size_t most_iterations = 65'000;  // with a margin for additions by compilers
  const std::size_t stretches = gpu::groups_for(transducers, shader::drive_group * shader::drive_sum_each);
  const std::size_t scaling = gpu::groups_for(transducers, shader::drive_group);
  // One iteration for each stretch and focus, one more for each stretch, and the scaling.
  return (most_iterations - scaling) / std::max<std::size_t>(1, stretches) - 1;
}

DrivePass::DrivePass(const gpu::Device& device)
    : focus_(device, "drive_focus", spirv::drive_focus_comp, sizeof(shader::DrivePush)),
      sum_(device, "drive_sum", spirv::drive_sum_comp, sizeof(shader::DrivePush)),
      weighted_(device, "drive_weighted", spirv::drive_weighted_comp, sizeof(shader::DrivePush)) {}

void DrivePass::record(VkCommandBuffer commands, const DriveBindings& bindings, const DriveBatch& batch) const {
  const shader::DrivePush push{batch.transducers, batch.slots, static_cast<std::uint32_t>(batch.weighting),
                               static_cast<std::uint32_t>(batch.constraint), batch.turned_foci};
  // The kernels write different slots, but to one buffer, so they need a barrier.
  bool first = true;
  const auto apart = [&] {
    if (!std::exchange(first, false)) gpu::compute_to_compute(commands);
  };
  const std::uint32_t groups = batch.transducers == 0 ? 0 : batch.slots;
  if (batch.single) {
    apart();
    focus_.dispatch(commands, spirv::drive_focus_buffers(bindings), push,
                    gpu::groups_for(batch.transducers, shader::drive_group * shader::drive_each),
                    gpu::groups_for(batch.slots, shader::drive_slots_per_group));
  }
  if (batch.several) {
    apart();
    sum_.dispatch(commands, spirv::drive_sum_buffers(bindings), push, groups);
  }
  if (batch.weighted) {
    apart();
    weighted_.dispatch(commands, spirv::drive_weighted_buffers(bindings), push, groups);
  }
}

shader::DrivePoint drive_point(const Vec3& metres, double turns_per_metre) {
  const Vec3 turns = metres * turns_per_metre;
  const Vec3 coarse = glm::floor(turns * 16.0 + 0.5) / 16.0;
  const Vec3 fine = turns - coarse;
  return {{static_cast<float>(coarse.x), static_cast<float>(coarse.y), static_cast<float>(coarse.z), 0},
          {static_cast<float>(fine.x), static_cast<float>(fine.y), static_cast<float>(fine.z), 0}};
}

std::uint32_t DriveMemory::fitting_slots(const gpu::Device& device, std::size_t transducers) {
  const std::uint64_t bytes = std::max<std::uint64_t>(1, transducers) * sizeof(TransducerDrive);
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(most_groups, device.limits().maxStorageBufferRange / bytes));
}

DriveMemory::DriveMemory(const gpu::Device& device, const Layout& layout, const DriveOptions& options,
                         std::uint32_t most_slots, std::uint32_t most_foci)
    : layout_(layout), options_(options), farthest_(layout), most_slots_(most_slots), most_foci_(most_foci) {
  if (options.transfer)
    throw bad_usage("a device computes the free field only: foci on a finger are driven on the host");
  const double turns_per_metre = options.medium.turns_per_metre();
  const std::uint32_t fitting = fitting_slots(device, layout.transducers.size());
  if (most_slots > fitting || layout.transducers.size() > max_transducers) {
    throw bad_usage(fmt::format("{} slots of {} transducers exceed what {} holds in one buffer: at most {} slots",
                                most_slots, layout.transducers.size(), device.description().name, fitting));
  }
  batch_.transducers = static_cast<std::uint32_t>(layout.transducers.size());
  transducers_ =
      gpu::Upload(device, std::max(1U, batch_.transducers) * sizeof(shader::DrivePoint), "drive transducers");
  // At least one: silent slots read an entry that they do not use.
  foci_ = gpu::Upload(device, std::max(1U, most_foci) * sizeof(shader::DriveFocus), "drive foci");
  slots_ = gpu::Upload(device, std::max(1U, most_slots) * sizeof(shader::DriveSlot), "drive slots");
  factors_ = gpu::Upload(device, std::max(1U, most_foci) * sizeof(shader::vec4), "focus factors");
  factor_texels_ = floats(device, factors_.ref(), "focus factors");
  transducer_texels_ = floats(device, transducers_.ref(), "drive transducers");
  focus_texels_ = floats(device, foci_.ref(), "drive foci");
  slot_texels_ = gpu::TexelView(device, slots_.ref(), VK_FORMAT_R32G32B32A32_UINT, "drive slots");
  const std::uint64_t drives = std::uint64_t{most_slots} * batch_.transducers;
  drives_ = gpu::Readback(device, drives * sizeof(TransducerDrive), "drives");
  std::ranges::transform(layout.transducers, transducers_.as<shader::DrivePoint>().begin(),
                         [&](const Transducer& t) { return drive_point(t.position, turns_per_metre); });
  if (options.solver != Solver::naive) {
    solve_.transducers = batch_.transducers;
    solve_.weighting = options.weighting;
    solve_.constraint = options.constraint;
    solve_.nearest = layout.transducer_radius_m * turns_per_metre;
    axes_ = gpu::Upload(device, std::max(1U, batch_.transducers) * sizeof(shader::vec4), "transducer axes");
    std::ranges::transform(layout.transducers, axes_.as<shader::vec4>().begin(), [](const Transducer& t) {
      return shader::vec4{static_cast<float>(t.axis.x), static_cast<float>(t.axis.y), static_cast<float>(t.axis.z), 0};
    });
    const std::vector<std::uint32_t> table =
        solver_directivity(options.directivity, 2 * std::numbers::pi * solve_.nearest);
    directivity_ = gpu::Upload(device, table.size() * sizeof(table[0]), "directivity");
    std::ranges::copy(table, directivity_.as<std::uint32_t>().begin());
    solver_scratch_ = gpu::Scratch(device, SolverPass::scratch(options.solver, most_foci), "solver scratch");
    weights_ = gpu::Buffer(device, std::max(1U, most_foci) * sizeof(shader::vec4), "focus weights");
    axis_texels_ = floats(device, axes_.ref(), "transducer axes");
    directivity_texels_ = gpu::TexelView(device, directivity_.ref(), VK_FORMAT_R32_UINT, "directivity");
    weight_texels_ = floats(device, weights_.ref(), "focus weights");
  }
  batch_.weighting = options.weighting;
  reserve_host_drives(device.description().ends_long_loops);
  clear();
}

void DriveMemory::reserve_host_drives(bool ends_long_loops) {
  pass_foci_ = ends_long_loops ? most_pass_foci(batch_.transducers) : std::numeric_limits<std::size_t>::max();
  const bool seeking = may_seek() || options_.gains_stay;
  if (pass_foci_ >= most_foci_ && !seeking && !options_.nulls) return;
  const std::size_t fewest = options_.nulls ? 1 : seeking ? 2 : pass_foci_ + 1;
  const std::size_t most = std::min<std::size_t>(most_slots_, most_foci_ / fewest);
  most_host_slots_ = most;
  host_slots_.reserve(layout_, options_, most, most_foci_);
  host_numbers_.reserve(most);
  host_drives_.reserve(most * batch_.transducers);
  if (seeking) ears_ = spread_over(layout_, loud_ears);
}

bool DriveMemory::may_seek() const {
  return is_gs_pat(options_.solver) && is_solved(options_, 2, batch_.transducers);
}

/// Whether the host computes the slot: because its phases are sought, or because under `normalise` its loudness depends
/// on its own gains, or may be that of other sums (drive.cpp). The kernels cannot do either.
bool DriveMemory::seeks(std::span<const SlotFocus> foci, std::size_t count) {
  if (!may_seek() && !options_.gains_stay) return false;
  ears_sources_.clear();
  for (const SlotFocus& focus : foci) {
    if (drivable(focus))
      ears_sources_.push_back({focus.position, farthest_.distance_from(focus.position), gain_of(focus)});
  }
  const bool equal = std::ranges::all_of(
      ears_sources_, [&](const FocusSource& source) { return source.gain == ears_sources_.front().gain; });
  const bool normalises = options_.constraint == Constraint::normalise;
  if (!equal && options_.gains_stay && normalises) return true;
  if (!may_seek() || !is_solved(options_, count, batch_.transducers)) return false;
  const auto near = [&] {
    ears_field_.set(ears_, options_.medium, options_.directivity);
    ears_field_.fill(ears_sources_, options_.weighting, ears_columns_);
    return are_near(ears_columns_, ears_matrix_);
  };
  if (normalises) return equal && near();
  return loud_effort(care_of(options_.solver), options_.constraint, count, batch_.transducers, near) != nullptr;
}

void DriveMemory::clear() {
  batch_.slots = 0;
  batch_.single = batch_.several = batch_.weighted = by_factors_ = false;
  batch_.constraint = options_.constraint;
  batch_.turned_foci = is_gs_pat(options_.solver) ? shader::solve_finger_foci : 0;
  solve_.sizes = 0;
  used_foci_ = used_entries_ = 0;
  host_slots_.clear();
  host_numbers_.clear();
  solved_ = false;
}

bool DriveMemory::add_host_slot(std::span<const SlotFocus> foci, std::span<const std::complex<double>> factors) {
  if (host_slots_.size() == most_host_slots_) return false;
  host_numbers_.push_back(batch_.slots);
  host_slots_.add(foci, factors);
  slots_.as<shader::DriveSlot>()[batch_.slots++] = {used_foci_, 0, 0, shader::drive_unsolved};
  batch_.single = true;
  return true;
}

void DriveMemory::solve_on_host() {
  host_drives_.resize(host_slots_.size() * batch_.transducers);
  host_slots_.solve(layout_, options_, host_drives_);
  solved_ = true;
}

bool DriveMemory::add_slot(std::span<const SlotFocus> foci) {
  const auto slots = slots_.as<shader::DriveSlot>();
  const auto count = static_cast<std::size_t>(std::ranges::count_if(foci, drivable));
  if (!fits(count)) return false;
  assert(!by_factors_);
  const bool silences = options_.nulls && count > 0;
  if (count > pass_foci_ || silences || seeks(foci, count)) return add_host_slot(foci, {});

  float shared = 0;
  for (const SlotFocus& focus : foci) {
    if (drivable(focus)) shared = std::max(shared, gain_of(focus));
  }
  const auto foci_here = static_cast<std::uint32_t>(count);
  const bool solved = is_solved(options_, count, batch_.transducers);
  slots[batch_.slots++] = {used_foci_, foci_here, shared, solved ? used_entries_ : shader::drive_unsolved};
  if (count <= 1) {
    batch_.single = true;
  } else if (!solved) {
    batch_.several = true;
  } else {
    batch_.weighted = options_.solver != Solver::greedy;
    solve_.sizes |= std::uint64_t{1} << (foci_here - 1);
    if (batch_.weighted) used_entries_ += foci_here * foci_here;
  }
  for (const SlotFocus& focus : foci) {
    if (drivable(focus)) add_focus(focus, shared > 0 ? gain_of(focus) / shared : 1);
  }
  return true;
}

bool DriveMemory::add_slot(std::span<const SlotFocus> foci, std::span<const std::complex<double>> factors) {
  assert(factors.size() == foci.size() && (by_factors_ || batch_.slots == 0));
  const auto count = static_cast<std::size_t>(std::ranges::count_if(foci, drivable));
  if (!fits(count)) return false;
  by_factors_ = true;
  batch_.constraint = Constraint::clamp;
  batch_.turned_foci = 0;
  if (count > pass_foci_) return add_host_slot(foci, factors);
  shader::DriveSlot& slot = slots_.as<shader::DriveSlot>()[batch_.slots++];
  slot = {used_foci_, static_cast<std::uint32_t>(count), 1, shader::drive_given};
  (count <= 1 ? batch_.single : batch_.weighted) = true;
  const auto store = factors_.as<shader::vec4>();
  for (std::size_t j = 0; j < foci.size(); ++j) {
    if (!drivable(foci[j])) continue;
    // The phase of a single focus has no effect, so its factor is a gain.
    if (count == 1) slot.gain = static_cast<float>(std::clamp(std::abs(factors[j]), 0.0, 1.0));
    store[used_foci_] = {0, 0, static_cast<float>(factors[j].real()), static_cast<float>(factors[j].imag())};
    add_focus(foci[j], 1);
  }
  return true;
}

void DriveMemory::add_focus(const SlotFocus& focus, float gain) {
  const shader::DrivePoint point = drive_point(focus.position, options_.medium.turns_per_metre());
  shader::DriveFocus entry{point.coarse, point.fine};
  const double reach = farthest_.distance_from(focus.position) * options_.medium.turns_per_metre();
  // A distance that no float distinguishes from 0 counts as at the focus.
  entry.coarse.w = reach > 1e-6 ? static_cast<float>(1 / reach) : 0;
  entry.fine.w = gain;
  foci_.as<shader::DriveFocus>()[used_foci_++] = entry;
}

void DriveMemory::record(VkCommandBuffer commands, const DrivePasses& passes) {
  // The previous batch wrote and read the same memory; see gpu/barrier.hpp.
  gpu::compute_to_compute(commands);
  if (!layout_sent_) {
    transducers_.record(commands);
    if (options_.solver != Solver::naive) {
      axes_.record(commands);
      directivity_.record(commands);
    }
  }
  layout_sent_ = true;
  foci_.record(commands, used_foci_ * sizeof(shader::DriveFocus));
  slots_.record(commands, batch_.slots * sizeof(shader::DriveSlot));
  if (by_factors_) factors_.record(commands, used_foci_ * sizeof(shader::vec4));
  if (solve_.sizes != 0) {
    solve_.slots = batch_.slots;
    passes.solver.record(commands,
                         {transducer_texels_.ref(), focus_texels_.ref(), slot_texels_.ref(), drives_.ref(),
                          weights_.ref(), axis_texels_.ref(), directivity_texels_.ref()},
                         solver_scratch_, solve_);
    gpu::compute_to_compute(commands);
  }
  passes.drives.record(commands,
                       {transducer_texels_.ref(), focus_texels_.ref(), slot_texels_.ref(), drives_.ref(),
                        by_factors_ ? factor_texels_.ref() : weight_texels_.ref()},
                       batch_);
  drives_.record(commands, std::uint64_t{batch_.slots} * batch_.transducers * sizeof(TransducerDrive));
}

std::span<const TransducerDrive> DriveMemory::drive(std::uint32_t slot) const {
  const std::size_t transducers = batch_.transducers;
  const auto found = std::ranges::lower_bound(host_numbers_, slot);  // they ascend
  if (found == host_numbers_.end() || *found != slot)
    return drives_.as<TransducerDrive>().subspan(slot * transducers, transducers);
  assert(solved_);
  return std::span(host_drives_)
      .subspan(static_cast<std::size_t>(found - host_numbers_.begin()) * transducers, transducers);
}

void compute_drives(DriveMemory& memory, const DrivePasses& passes, const gpu::Recorder& recorder,
                    gpu::Timeline& timeline) {
  memory.record(recorder.begin(), passes);
  const std::uint64_t submitted = timeline.submit(recorder.end());
  memory.solve_on_host();
  timeline.wait(submitted);
}

}  // namespace palpa::array
