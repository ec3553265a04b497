#include "touch/fingers/fingers_pass.hpp"

#include <cstddef>
#include <span>

#include "gpu/barrier.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers_math.h"
#include "spirv/fingers_blocks.comp.hpp"
#include "spirv/fingers_collect.comp.hpp"
#include "spirv/fingers_crowded.comp.hpp"
#include "spirv/fingers_gather.comp.hpp"
#include "spirv/fingers_insert.comp.hpp"
#include "spirv/fingers_label.comp.hpp"
#include "spirv/fingers_link.comp.hpp"
#include "spirv/fingers_place.comp.hpp"
#include "spirv/fingers_prepare.comp.hpp"
#include "spirv/fingers_select.comp.hpp"
#include "spirv/fingers_undecided.comp.hpp"
#include "touch/fingers/finger_cells.hpp"

namespace palpa::touch {

static_assert(max_fingers == shader::fingers_most);
static_assert(sizeof(shader::SolidRecord) == std::size_t{16} * shader::fingers_solid_texels);
static_assert(offsetof(shader::SolidRecord, centre) == std::size_t{16} * shader::fingers_centre_texel);

namespace {

gpu::ComputePipeline kernel(const gpu::Device& device, const char* name, std::span<const std::uint32_t> spirv,
                            std::uint32_t texels, std::span<const std::uint32_t> constants = {}) {
  return {device, name, spirv, {shader::fingers_buffers, sizeof(shader::FingersPush), constants, texels}};
}

constexpr std::uint32_t test_all = 1;
constexpr std::uint32_t with_deep = 1;

}  // namespace

void FingersPass::prepare(const Parameters& parameters) {
  if (!select_) {
    prepare_ = kernel(*device_, "fingers prepare", spirv::fingers_prepare_comp, 0);
    insert_ = kernel(*device_, "fingers insert", spirv::fingers_insert_comp, shader::fingers_insert_texels);
    collect_ = kernel(*device_, "fingers collect", spirv::fingers_collect_comp, shader::fingers_collect_texels);
    place_ = kernel(*device_, "fingers place", spirv::fingers_place_comp, shader::fingers_place_texels);
    blocks_ = kernel(*device_, "fingers blocks", spirv::fingers_blocks_comp, shader::fingers_blocks_texels);
    link_ = kernel(*device_, "fingers link", spirv::fingers_link_comp, shader::fingers_link_texels);
    crowded_ = kernel(*device_, "fingers crowded", spirv::fingers_crowded_comp, shader::fingers_crowded_texels);
    rest_ = kernel(*device_, "fingers rest", spirv::fingers_link_comp, shader::fingers_link_texels, {&test_all, 1});
    undecided_ = kernel(*device_, "fingers undecided", spirv::fingers_undecided_comp, shader::fingers_crowded_texels);
    select_ = {*device_, "fingers select", spirv::fingers_select_comp, {shader::fingers_select_buffers}};
  }
  if (parameters.cluster != Cluster::inside) {
    if (!label_) label_ = kernel(*device_, "fingers label", spirv::fingers_label_comp, shader::fingers_label_texels);
  } else if (!gather_) {
    label_inside_ = kernel(*device_, "fingers label inside", spirv::fingers_label_comp, shader::fingers_label_texels,
                           {&with_deep, 1});
    gather_ = {*device_,
               "fingers gather",
               spirv::fingers_gather_comp,
               {shader::fingers_gather_buffers, sizeof(shader::GatherPush)}};
  }
}

std::vector<gpu::ScratchPiece> FingersPass::scratch(const Room& room) {
  const std::uint64_t points = room.clustered();
  const std::uint64_t slots = shader::table_slots(room.clustered());
  std::vector<gpu::ScratchPiece> of(pieces);
  of[nodes] = {"finger nodes", 2 * points * sizeof(shader::uvec4), VK_FORMAT_R32G32B32A32_UINT};
  of[tiles] = {"finger tiles", slots * sizeof(shader::uvec4), VK_FORMAT_R32G32B32A32_UINT};
  of[bases] = {"finger bases", slots * 4, VK_FORMAT_R32_UINT};
  of[places] = {"finger places", points * 4, VK_FORMAT_R32_UINT};
  of[list] = {"finger blocks", points * 4, VK_FORMAT_R32_UINT};
  of[links] = {"finger links", std::uint64_t{8} * shader::links_room(room.clustered()), VK_FORMAT_R32G32_UINT};
  of[groups] = {"finger groups", points * 4, VK_FORMAT_R32_UINT};
  of[crowded] = {"finger crowded", points * sizeof(shader::CrowdedPair) * shader::fingers_crowded_per_contact};
  of[forest] = {"finger forest", points * 4, VK_FORMAT_R32_UINT};
  of[work] = {"finger work", sizeof(shader::FingersWork)};
  of[inside_total] = {"inside total", sizeof(shader::ScanTotal)};
  if (room.inside) {
    of[inside_points] = {"points inside", points * sizeof(shader::ContactRecord), VK_FORMAT_R32G32B32A32_UINT};
  } else {
    of[inside_points] = {"points inside", 0};
  }
  return of;
}

void FingersPass::record(VkCommandBuffer commands, const FingersBindings& b, const gpu::Scratch& s, const Room& room,
                         const Parameters& parameters, gpu::Timestamps* times) const {
  const float gap = float_gap(parameters);
  const bool inside = parameters.cluster == Cluster::inside;
  const gpu::BufferRef total = inside ? s[inside_total] : b.total, contacts = inside ? s[inside_points] : b.contacts;
  const shader::FingersPush push{cells_per_metre(gap), gap * gap, room.clustered(), parameters.min_points};
  if (inside) {
    const shader::GatherPush gather{room.contacts, room.deep, 0, 0};
    gather_.dispatch(commands, {b.total, b.contacts, b.deep_total, b.deep, s[inside_total], s[inside_points]}, gather,
                     shader::contacts_most_groups / 2);
    gpu::compute_to_compute(commands);
  }
  // `left`: where the kernel lists what it leaves undecided.
  const auto run = [&](const gpu::ComputePipeline& kernel, gpu::BufferRef where, VkDeviceSize at,
                       Piece left = crowded) {
    kernel.dispatch_indirect(commands,
                             {total, contacts, b.solids, s[nodes], s[tiles], s[bases], s[places], s[list], s[links],
                              s[groups], s[left], s[work], s[forest], b.parents, b.clusters, s[forest]},
                             push, gpu::groups_in(where, at));
    gpu::compute_to_compute(commands);
  };
  constexpr VkDeviceSize per_contact = offsetof(shader::ScanTotal, groups_x);
  run(prepare_, total, per_contact);
  run(insert_, total, per_contact);
  run(collect_, s[work], offsetof(shader::FingersWork, collect_x));
  run(place_, total, per_contact);
  if (times) times->mark(commands, "cells");
  run(blocks_, s[work], offsetof(shader::FingersWork, blocks_x));
  run(link_, s[work], offsetof(shader::FingersWork, links_x));
  run(crowded_, s[work], offsetof(shader::FingersWork, crowded_x));
  run(rest_, s[work], offsetof(shader::FingersWork, rest_x), links);
  run(undecided_, s[work], offsetof(shader::FingersWork, undecided_x));
  if (times) times->mark(commands, "links");
  run(inside ? label_inside_ : label_, total, per_contact);
  select_.dispatch(commands, {b.total, b.length, s[groups], b.clusters, b.contacts, b.header, b.fingers, s[work]},
                   gpu::Push::none(), 1);
  if (times) times->mark(commands, "fingers");
}

}  // namespace palpa::touch
