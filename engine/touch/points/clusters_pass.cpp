#include "touch/points/clusters_pass.hpp"

#include <cstddef>
#include <span>

#include "gpu/barrier.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/clusters/clusters_math.h"
#include "shaders/touch/contacts/contacts.h"
#include "spirv/clusters_blocks.comp.hpp"
#include "spirv/clusters_collect.comp.hpp"
#include "spirv/clusters_crowded.comp.hpp"
#include "spirv/clusters_gather.comp.hpp"
#include "spirv/clusters_insert.comp.hpp"
#include "spirv/clusters_label.comp.hpp"
#include "spirv/clusters_link.comp.hpp"
#include "spirv/clusters_place.comp.hpp"
#include "spirv/clusters_prepare.comp.hpp"
#include "spirv/clusters_select.comp.hpp"
#include "spirv/clusters_undecided.comp.hpp"
#include "touch/points/cluster_cells.hpp"

namespace palpa::touch {

static_assert(max_fingers == shader::clusters_most_selected);
static_assert(sizeof(shader::SolidRecord) == std::size_t{16} * shader::clusters_solid_texels);
static_assert(offsetof(shader::SolidRecord, centre) == std::size_t{16} * shader::clusters_centre_texel);

namespace {

/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct Buffers : ClustersBindings {
  gpu::BufferRef nodes = {}, tiles = {}, bases = {}, places = {}, list = {}, links = {}, groups_of_block = {},
                 crowded = {}, undecided = {}, left = {}, work = {}, forest = {}, seen = {}, large = {},
                 inside_total = {}, inside = {};
};

gpu::ComputePipeline pipeline(const gpu::Device& device, const char* name, const gpu::Kernel& kernel,
                              std::span<const std::uint32_t> constants = {}) {
  return {device, name, kernel, sizeof(shader::ClustersPush), constants};
}

constexpr std::uint32_t test_all = 1;
constexpr std::uint32_t with_deep = 1;

}  // namespace

void ClustersPass::prepare(const FingerOptions& parameters) {
  if (!select_) {
    prepare_ = pipeline(*device_, "clusters prepare", spirv::clusters_prepare_comp);
    insert_ = pipeline(*device_, "clusters insert", spirv::clusters_insert_comp);
    collect_ = pipeline(*device_, "clusters collect", spirv::clusters_collect_comp);
    place_ = pipeline(*device_, "clusters place", spirv::clusters_place_comp);
    blocks_ = pipeline(*device_, "clusters blocks", spirv::clusters_blocks_comp);
    link_ = pipeline(*device_, "clusters link", spirv::clusters_link_comp);
    crowded_ = pipeline(*device_, "clusters crowded", spirv::clusters_crowded_comp);
    rest_ = pipeline(*device_, "clusters rest", spirv::clusters_link_comp, {&test_all, 1});
    undecided_ = pipeline(*device_, "clusters undecided", spirv::clusters_undecided_comp);
    select_ = {*device_, "clusters select", spirv::clusters_select_comp, 0};
  }
  if (parameters.cluster != Cluster::inside) {
    if (!label_) label_ = pipeline(*device_, "clusters label", spirv::clusters_label_comp);
  } else if (!gather_) {
    label_inside_ = pipeline(*device_, "clusters label inside", spirv::clusters_label_comp, {&with_deep, 1});
    gather_ = {*device_, "clusters gather", spirv::clusters_gather_comp, sizeof(shader::GatherPush)};
  }
}

std::vector<gpu::ScratchBuffer> ClustersPass::scratch(const Capacity& capacity) {
  const std::uint64_t points = capacity.clustered();
  const std::uint64_t slots = shader::table_slots(capacity.clustered());
  std::vector<gpu::ScratchBuffer> of(scratch_count);
  of[nodes] = {"cluster nodes", 2 * points * sizeof(shader::uvec4), VK_FORMAT_R32G32B32A32_UINT};
  of[tiles] = {"cluster tiles", slots * sizeof(shader::uvec4), VK_FORMAT_R32G32B32A32_UINT};
  of[bases] = {"cluster bases", slots * 4, VK_FORMAT_R32_UINT};
  of[places] = {"cluster places", points * 4, VK_FORMAT_R32_UINT};
  of[list] = {"cluster blocks", points * 4, VK_FORMAT_R32_UINT};
  of[links] = {"cluster links", std::uint64_t{8} * shader::links_room(capacity.clustered()), VK_FORMAT_R32G32_UINT};
  of[groups] = {"cluster groups", points * 4, VK_FORMAT_R32_UINT};
  of[crowded] = {"cluster crowded", points * sizeof(shader::CrowdedPair) * shader::clusters_crowded_per_contact};
  of[forest] = {"cluster forest", points * 4, VK_FORMAT_R32_UINT};
  of[work] = {"cluster work", sizeof(shader::ClustersWork)};
  of[inside_total] = {"inside total", sizeof(shader::ScanTotal)};
  if (capacity.inside) {
    of[inside_points] = {"points inside", points * sizeof(shader::ContactRecord), VK_FORMAT_R32G32B32A32_UINT};
  } else {
    of[inside_points] = {"points inside", 0};
  }
  return of;
}

void ClustersPass::record(VkCommandBuffer commands, const ClustersBindings& b, const gpu::Scratch& s,
                          const Capacity& capacity, const FingerOptions& parameters, gpu::Timestamps* times) const {
  const float gap = float_gap(parameters);
  const bool inside = parameters.cluster == Cluster::inside;
  const shader::ClustersPush push{cells_per_metre(gap), gap * gap, capacity.clustered(), parameters.min_points};
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
    const shader::GatherPush gather{capacity.contacts, capacity.deep, 0, 0};
    gather_.dispatch(commands, spirv::clusters_gather_buffers(given), gather, shader::contacts_most_groups / 2);
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
  run(prepare_, spirv::clusters_prepare_buffers(clustered), total, per_contact);
  run(insert_, spirv::clusters_insert_buffers(clustered), total, per_contact);
  run(collect_, spirv::clusters_collect_buffers(clustered), s[work], offsetof(shader::ClustersWork, collect_x));
  run(place_, spirv::clusters_place_buffers(clustered), total, per_contact);
  if (times) times->mark(commands, "cells");
  run(blocks_, spirv::clusters_blocks_buffers(clustered), s[work], offsetof(shader::ClustersWork, blocks_x));
  run(link_, spirv::clusters_link_buffers(clustered), s[work], offsetof(shader::ClustersWork, links_x));
  run(crowded_, spirv::clusters_crowded_buffers(clustered), s[work], offsetof(shader::ClustersWork, crowded_x));
  clustered.left = clustered.undecided;
  run(rest_, spirv::clusters_link_buffers(clustered), s[work], offsetof(shader::ClustersWork, rest_x));
  run(undecided_, spirv::clusters_undecided_buffers(clustered), s[work], offsetof(shader::ClustersWork, undecided_x));
  if (times) times->mark(commands, "links");
  run(inside ? label_inside_ : label_, spirv::clusters_label_buffers(clustered), total, per_contact);
  select_.dispatch(commands, spirv::clusters_select_buffers(given), gpu::Push::none(), 1);
  if (times) times->mark(commands, "clusters");
}

}  // namespace palpa::touch
