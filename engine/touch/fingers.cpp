#include "touch/fingers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/scan.hpp"
#include "spirv/fingers_insert.comp.hpp"
#include "spirv/fingers_label.comp.hpp"
#include "spirv/fingers_link.comp.hpp"
#include "spirv/fingers_prepare.comp.hpp"
#include "spirv/fingers_select.comp.hpp"

namespace palpa::touch {

static_assert(max_fingers == shader::fingers_most);

void check(const Parameters& parameters, const PlaneTable& table) {
  if (!std::isfinite(parameters.delta_m) || parameters.delta_m <= 0) {
    throw bad_usage(fmt::format("delta is {} m: give a positive length such as 1.5mm", parameters.delta_m));
  }
  if (!std::isfinite(parameters.finger_gap_m) || parameters.finger_gap_m <= 0) {
    throw bad_usage(fmt::format("the finger gap is {} m: give a positive length such as 5mm", parameters.finger_gap_m));
  }
  if (parameters.foci < 1 || parameters.foci > max_foci) {
    throw bad_usage(fmt::format("{} foci: give 1 to {}", parameters.foci, max_foci));
  }
  double reach = 0;
  for (const shader::SolidRecord& solid : table.solids) {
    for (const float side : {solid.high.x, solid.high.y, solid.high.z})
      reach = std::max(reach, static_cast<double>(side));
    for (const float side : {solid.low.x, solid.low.y, solid.low.z})
      reach = std::max(reach, -static_cast<double>(side));
  }
  const double least = reach / (shader::fingers_cell_side * shader::fingers_most_cells);
  if (parameters.finger_gap_m < least) {
    throw bad_usage(fmt::format("the finger gap is {} m: at least {:.2g} m for a solid of {:.3g} m",
                                parameters.finger_gap_m, least * 1.01, 2 * reach));
  }
}

std::uint32_t slots_for(std::uint32_t contacts) {
  return contacts <= 32 ? 64 : 2 * std::bit_ceil(contacts);
}

FingersPass::FingersPass(const gpu::Device& device)
    : prepare_(device, "fingers prepare", spirv::fingers_prepare_comp,
               {shader::fingers_prepare_buffers, sizeof(shader::FingersPush)}),
      insert_(device, "fingers insert", spirv::fingers_insert_comp,
              {shader::fingers_insert_buffers, sizeof(shader::FingersPush)}),
      link_(device, "fingers link", spirv::fingers_link_comp,
            {shader::fingers_link_buffers, sizeof(shader::FingersPush)}),
      label_(device, "fingers label", spirv::fingers_label_comp,
             {shader::fingers_label_buffers, sizeof(shader::FingersPush)}),
      select_(device, "fingers select", spirv::fingers_select_comp,
              {shader::fingers_select_buffers, sizeof(shader::FingersPush)}) {}

void FingersPass::record(VkCommandBuffer commands, const FingersBuffers& b, const PlaneTable& table,
                         const Parameters& parameters) const {
  check(parameters, table);
  // A gap beyond every solid means one cluster per solid; its square must stay a number.
  const float gap = std::min(static_cast<float>(parameters.finger_gap_m), 1e9F);
  shader::FingersPush push{};
  push.cells_per_metre = 1.0F / (shader::fingers_cell_side * gap);
  push.limit = gap * gap;
  push.most_contacts = b.most_contacts;
  push.min_points = parameters.min_points;
  const gpu::BufferRef groups{b.total.buffer, b.total.offset + offsetof(shader::ScanTotal, groups_x),
                              sizeof(VkDispatchIndirectCommand)};

  prepare_.dispatch_indirect(commands,
                             {b.total, b.nodes, b.cells, b.parents, b.places, b.slots, b.sizes, b.contacts, b.solids},
                             &push, groups);
  gpu::compute_to_compute(commands);
  insert_.dispatch_indirect(commands, {b.total, b.nodes, b.cells, b.parents, b.places, b.slots}, &push, groups);
  gpu::compute_to_compute(commands);
  push.end_neighbour = shader::fingers_near;
  link_.dispatch_indirect(commands, {b.total, b.nodes, b.cells, b.parents, b.places, b.slots}, &push, groups);
  gpu::compute_to_compute(commands);
  push.first_neighbour = shader::fingers_near;
  push.end_neighbour = shader::fingers_neighbours;
  link_.dispatch_indirect(commands, {b.total, b.nodes, b.cells, b.parents, b.places, b.slots}, &push, groups);
  gpu::compute_to_compute(commands);
  label_.dispatch_indirect(commands, {b.total, b.nodes, b.cells, b.parents, b.places, b.slots, b.sizes}, &push, groups);
  gpu::compute_to_compute(commands);
  select_.dispatch(commands, {b.total, b.length, b.sizes, b.contacts, b.header, b.fingers}, &push, 1);
}

}  // namespace palpa::touch
