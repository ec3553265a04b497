#include "touch/fingers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "gpu/scan.hpp"
#include "spirv/fingers_blocks.comp.hpp"
#include "spirv/fingers_crowded.comp.hpp"
#include "spirv/fingers_gather.comp.hpp"
#include "spirv/fingers_insert.comp.hpp"
#include "spirv/fingers_label.comp.hpp"
#include "spirv/fingers_link.comp.hpp"
#include "spirv/fingers_prepare.comp.hpp"
#include "spirv/fingers_select.comp.hpp"

namespace palpa::touch {

static_assert(max_fingers == shader::fingers_most);

void check(const Parameters& parameters, const SceneTable& table) {
  if (!std::isfinite(parameters.delta_m) || parameters.delta_m <= 0) {
    throw bad_usage(fmt::format("delta is {} m: give a positive length such as 1.5mm", parameters.delta_m));
  }
  if (!std::isfinite(parameters.finger_gap_m) || parameters.finger_gap_m <= 0) {
    throw bad_usage(fmt::format("the finger gap is {} m: give a positive length such as 5mm", parameters.finger_gap_m));
  }
  if (!std::isfinite(parameters.finger_width_m) || parameters.finger_width_m < 0) {
    throw bad_usage(fmt::format("the finger width is {} m: give a length such as 25mm, or 0 to join nothing",
                                parameters.finger_width_m));
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
  const double half_size = reach;
  reach *= std::numbers::sqrt3;  // it may be turned
  for (std::uint32_t s = 0; s < table.solids.size(); ++s) {
    if (table.solids[s].by_surface != shader::asked_by_surface) continue;
    const geometry::SurfaceOptions& made = table.surfaces[s].options;
    if (table.delta_m(s, parameters) > made.reach_m * (1 + 1e-6) || (parameters.wants_deep() && !made.deep)) {
      throw bad_usage(
          fmt::format("solid {} was prepared for contacts up to {} m deep{}; prepare it for these parameters", s,
                      made.reach_m, made.deep ? "" : " and no deep points"));
    }
  }
  const double least = reach / (2e-3 * shader::fingers_cell_thousandths * shader::fingers_most_blocks);
  if (parameters.finger_gap_m < least) {
    throw bad_usage(fmt::format("the finger gap is {} m: at least {:.3g} m for a solid of {:.3g} m",
                                parameters.finger_gap_m, least * 1.01, 2 * half_size));
  }
}

std::uint32_t slots_for(std::uint32_t contacts) {
  return contacts <= 32 ? 64 : 2 * std::bit_ceil(contacts);
}

namespace {

gpu::ComputePipeline pipeline(const gpu::Device& device, const char* name, std::span<const std::uint32_t> spirv,
                              std::span<const std::uint32_t> constants = {}) {
  return {device, name, spirv, {shader::fingers_buffers, sizeof(shader::FingersPush), constants}};
}

constexpr std::uint32_t test_all = 1;
constexpr std::uint32_t with_deep = 1;

}  // namespace

FingersPass::FingersPass(const gpu::Device& device)
    : gather_(device, "fingers gather", spirv::fingers_gather_comp,
              {shader::fingers_gather_buffers, sizeof(shader::GatherPush)}),
      label_inside_(pipeline(device, "fingers label inside", spirv::fingers_label_comp, {&with_deep, 1})),
      prepare_(pipeline(device, "fingers prepare", spirv::fingers_prepare_comp)),
      insert_(pipeline(device, "fingers insert", spirv::fingers_insert_comp)),
      blocks_(pipeline(device, "fingers blocks", spirv::fingers_blocks_comp)),
      link_(pipeline(device, "fingers link", spirv::fingers_link_comp)),
      crowded_(pipeline(device, "fingers crowded", spirv::fingers_crowded_comp)),
      rest_(pipeline(device, "fingers rest", spirv::fingers_link_comp, {&test_all, 1})),
      label_(pipeline(device, "fingers label", spirv::fingers_label_comp)),
      select_(device, "fingers select", spirv::fingers_select_comp,
              {shader::fingers_select_buffers, sizeof(shader::FingersPush)}) {}

void FingersPass::record(VkCommandBuffer commands, const FingersBuffers& b, const SceneTable& table,
                         const Parameters& parameters, gpu::Timestamps* times) const {
  check(parameters, table);
  const float gap = float_gap(parameters);
  const bool inside = parameters.cluster == Cluster::inside;
  const gpu::BufferRef total = inside ? b.inside_total : b.total, contacts = inside ? b.inside : b.contacts;
  shader::FingersPush push{cells_per_metre(gap), gap * gap, b.most_contacts, parameters.min_points};
  if (inside) {
    push.most_contacts += b.most_deep;
    const shader::GatherPush gather{b.most_contacts, b.most_deep, 0, 0};
    gather_.dispatch(commands, {b.total, b.contacts, b.deep_total, b.deep, b.inside_total, b.inside}, gather,
                     shader::contacts_most_groups / 2);
    gpu::compute_to_compute(commands);
  }
  const auto run = [&](const gpu::ComputePipeline& stage, gpu::BufferRef where, VkDeviceSize groups) {
    stage.dispatch_indirect(commands,
                            {total, contacts, b.solids, b.nodes, b.keys, b.places, b.slots, b.heads, b.list, b.crowded,
                             b.work, b.parents, b.clusters, b.groups},
                            push, {where.buffer, where.offset + groups, sizeof(VkDispatchIndirectCommand)});
    gpu::compute_to_compute(commands);
  };
  constexpr VkDeviceSize per_contact = offsetof(shader::ScanTotal, groups_x);
  run(prepare_, total, per_contact);
  run(insert_, total, per_contact);
  if (times) times->mark(commands, "cells");
  run(blocks_, b.work, offsetof(shader::FingersWork, blocks_x));
  run(link_, b.work, offsetof(shader::FingersWork, links_x));
  run(crowded_, b.work, offsetof(shader::FingersWork, crowded_x));
  run(rest_, b.work, offsetof(shader::FingersWork, rest_x));
  if (times) times->mark(commands, "links");
  run(inside ? label_inside_ : label_, total, per_contact);
  push.most_contacts = b.most_contacts;
  select_.dispatch(commands, {b.total, b.length, b.parents, b.clusters, b.contacts, b.header, b.fingers}, push, 1);
  if (times) times->mark(commands, "fingers");
}

}  // namespace palpa::touch
