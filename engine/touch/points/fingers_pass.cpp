#include "touch/points/fingers_pass.hpp"

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
#include "touch/points/finger_cells.hpp"

namespace palpa::touch {

static_assert(max_fingers == shader::fingers_most);
static_assert(sizeof(shader::SolidRecord) == std::size_t{16} * shader::fingers_solid_texels);
static_assert(offsetof(shader::SolidRecord, centre) == std::size_t{16} * shader::fingers_centre_texel);

namespace {

/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct Buffers : FingersBindings {
  gpu::BufferRef nodes = {}, tiles = {}, bases = {}, places = {}, list = {}, links = {}, groups_of_block = {},
                 crowded = {}, undecided = {}, left = {}, work = {}, forest = {}, seen = {}, large = {},
                 inside_total = {}, inside = {};
};

gpu::ComputePipeline pipeline(const gpu::Device& device, const char* name, const gpu::Kernel& kernel,
                              std::span<const std::uint32_t> constants = {}) {
  return {device, name, kernel, sizeof(shader::FingersPush), constants};
}

constexpr std::uint32_t test_all = 1;
constexpr std::uint32_t with_deep = 1;

}  // namespace

void FingersPass::prepare(const Parameters& parameters) {
  if (!select_) {
    prepare_ = pipeline(*device_, "fingers prepare", spirv::fingers_prepare_comp);
    insert_ = pipeline(*device_, "fingers insert", spirv::fingers_insert_comp);
    collect_ = pipeline(*device_, "fingers collect", spirv::fingers_collect_comp);
    place_ = pipeline(*device_, "fingers place", spirv::fingers_place_comp);
    blocks_ = pipeline(*device_, "fingers blocks", spirv::fingers_blocks_comp);
    link_ = pipeline(*device_, "fingers link", spirv::fingers_link_comp);
    crowded_ = pipeline(*device_, "fingers crowded", spirv::fingers_crowded_comp);
    rest_ = pipeline(*device_, "fingers rest", spirv::fingers_link_comp, {&test_all, 1});
    undecided_ = pipeline(*device_, "fingers undecided", spirv::fingers_undecided_comp);
    select_ = {*device_, "fingers select", spirv::fingers_select_comp, 0};
  }
  if (parameters.cluster != Cluster::inside) {
    if (!label_) label_ = pipeline(*device_, "fingers label", spirv::fingers_label_comp);
  } else if (!gather_) {
    label_inside_ = pipeline(*device_, "fingers label inside", spirv::fingers_label_comp, {&with_deep, 1});
    gather_ = {*device_, "fingers gather", spirv::fingers_gather_comp, sizeof(shader::GatherPush)};
  }
}

std::vector<gpu::ScratchBuffer> FingersPass::scratch(const Room& room) {
  const std::uint64_t points = room.clustered();
  const std::uint64_t slots = shader::table_slots(room.clustered());
  std::vector<gpu::ScratchBuffer> of(scratch_count);
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
  const shader::FingersPush push{cells_per_metre(gap), gap * gap, room.clustered(), parameters.min_points};
  Buffers given{b};
  given.nodes = s[nodes];
  given.tiles = s[tiles];
  given.bases = s[bases];
  given.places = s[places];
  given.list = s[list];
  given.links = s[links];
  given.groups_of_block = s[groups];
  given.crowded = s[crowded];
  given.undecided = s[links];  // touching blocks have been processed by then
  given.left = s[crowded];
  given.work = s[work];
  given.forest = s[forest];
  given.seen = s[forest];
  given.large = s[groups];  // after the last use of the groups
  given.inside_total = s[inside_total];
  given.inside = s[inside_points];
  Buffers clustered = given;
  if (inside) {
    const shader::GatherPush gather{room.contacts, room.deep, 0, 0};
    gather_.dispatch(commands, spirv::fingers_gather_buffers(given), gather, shader::contacts_most_groups / 2);
    gpu::compute_to_compute(commands);
    clustered.total = given.inside_total;
    clustered.contacts = given.inside;
  }
  const auto run = [&](const gpu::ComputePipeline& kernel, const gpu::KernelBuffers& buffers, gpu::BufferRef where,
                       VkDeviceSize at) {
    kernel.dispatch_indirect(commands, buffers, push, gpu::groups_in(where, at));
    gpu::compute_to_compute(commands);
  };
  constexpr VkDeviceSize per_contact = offsetof(shader::ScanTotal, groups_x);
  const gpu::BufferRef total = clustered.total;
  run(prepare_, spirv::fingers_prepare_buffers(clustered), total, per_contact);
  run(insert_, spirv::fingers_insert_buffers(clustered), total, per_contact);
  run(collect_, spirv::fingers_collect_buffers(clustered), s[work], offsetof(shader::FingersWork, collect_x));
  run(place_, spirv::fingers_place_buffers(clustered), total, per_contact);
  if (times) times->mark(commands, "cells");
  run(blocks_, spirv::fingers_blocks_buffers(clustered), s[work], offsetof(shader::FingersWork, blocks_x));
  run(link_, spirv::fingers_link_buffers(clustered), s[work], offsetof(shader::FingersWork, links_x));
  run(crowded_, spirv::fingers_crowded_buffers(clustered), s[work], offsetof(shader::FingersWork, crowded_x));
  clustered.left = clustered.undecided;
  run(rest_, spirv::fingers_link_buffers(clustered), s[work], offsetof(shader::FingersWork, rest_x));
  run(undecided_, spirv::fingers_undecided_buffers(clustered), s[work], offsetof(shader::FingersWork, undecided_x));
  if (times) times->mark(commands, "links");
  run(inside ? label_inside_ : label_, spirv::fingers_label_buffers(clustered), total, per_contact);
  select_.dispatch(commands, spirv::fingers_select_buffers(given), gpu::Push::none(), 1);
  if (times) times->mark(commands, "fingers");
}

}  // namespace palpa::touch
