#include "touch/contacts/contacts_pass.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>

#include "base/error.hpp"
#include "gpu/barrier.hpp"
#include "shaders/shared/scan.h"
#include "shaders/touch/contacts/contacts.h"
#include "spirv/contacts_find.comp.hpp"
#include "spirv/contacts_pack.comp.hpp"
#include "spirv/contacts_surface.comp.hpp"

namespace palpa::touch {
namespace {

/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct Buffers : ContactsBindings {
  gpu::BufferRef hits = {}, masks = {}, counts = {}, deep_masks = {}, deep_counts = {};
  gpu::BufferRef surface_cells = {}, surface_runs = {}, surface_triangles = {}, surface_signs = {},
                 surface_corners = {}, parts_words = {};
};

/// The maximum number of words of 32 points that chunks can cover, for any number of rounds: the last chunk may begin
/// just before the last point.
std::uint64_t mask_words(std::uint32_t points) {
  constexpr std::uint32_t longest_round = shader::contacts_chunks * shader::contacts_group;
  return (std::uint64_t{gpu::groups_for(points, longest_round)} * (longest_round + shader::contacts_group)) / 32;
}

std::uint32_t whole_fours(std::uint32_t chunks) {
  return (chunks + 3) / 4 * 4;
}

/// The maximum for any number of rounds per chunk.
std::uint32_t most_chunks(std::uint32_t points) {
  return std::max(shader::contacts_chunks, whole_fours(gpu::groups_for(points, shader::contacts_group)));
}

bool any_asked_by(const PreparedSolids& solids, std::uint32_t kind) {
  return std::any_of(solids.records.begin(), solids.records.end(),
                     [&](const shader::SolidRecord& solid) { return solid.asked_by == kind; });
}

}  // namespace

ContactsPass::Kernel ContactsPass::kernel_for(const PreparedSolids& solids) {
  if (any_asked_by(solids, shader::asked_by_parts)) return by_parts;
  return any_asked_by(solids, shader::asked_by_surface) ? by_surface : by_planes;
}

void ContactsPass::prepare(const PreparedSolids& solids, const FingerOptions& parameters) {
  if (device_->description().ends_long_loops && solids.iterations > shader::contacts_most_iterations) {
    const std::string fault = fmt::format(
        "the scene's {} solids can take {} looks at one skin point, but {} allows {}: give fewer or simpler solids, or "
        "compute on the CPU (--backend cpu)",
        solids.records.size(), solids.iterations, device_->description().name, shader::contacts_most_iterations);
    throw solids.file.empty() ? bad_usage(fault) : bad_input(solids.file, fault);
  }
  if (!pack_) {
    pack_ = {*device_, "contacts pack", spirv::contacts_pack_comp, sizeof(shader::ContactsPush)};
  }
  const Kernel kernel = kernel_for(solids);
  const std::uint32_t one = solids.records.size() == 1 ? 1 : 0, deep = parameters.wants_deep() ? 1 : 0;
  gpu::ComputePipeline& find = find_[kernel][one][deep];
  if (find) return;
  const std::array<std::uint32_t, 3> constants{one, deep, kernel == by_parts ? 1U : 0U};
  if (kernel == by_planes) {
    find = {*device_, "contacts find", spirv::contacts_find_comp, sizeof(shader::ContactsPush),
            std::span(constants).first(2)};
  } else {
    find = {*device_, kernel == by_parts ? "contacts parts" : "contacts surface", spirv::contacts_surface_comp,
            sizeof(shader::ContactsPush), constants};
  }
}

std::vector<gpu::ScratchBuffer> ContactsPass::scratch(const Capacity& capacity) {
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[hits] = {"contact hits", std::uint64_t{capacity.points} * sizeof(shader::Hit)};
  list[masks] = {"contact masks", mask_words(capacity.points) * 4};
  list[counts] = {"contact counts", std::uint64_t{most_chunks(capacity.points)} * 4};
  list[deep_masks] = {"deep masks", capacity.deep == 0 ? 0 : mask_words(capacity.points) * 4};
  list[deep_counts] = {"deep counts", capacity.deep == 0 ? 0 : std::uint64_t{most_chunks(capacity.points)} * 4};
  return list;
}

shader::ScanGroups ContactsPass::groups(const gpu::Device& device, const Capacity& capacity,
                                        const PreparedSolids& solids) {
  constexpr std::uint32_t all = shader::contacts_most_points;
  const std::uint32_t rounds =
      device.description().ends_long_loops
          ? std::clamp(shader::contacts_most_iterations / std::max(solids.iterations, 1U), 1U, all)
          : all;
  return {rounds * shader::contacts_group, shader::contacts_chunks, most_chunks(capacity.points), 4};
}

void ContactsPass::record(VkCommandBuffer commands, const ContactsBindings& b, const gpu::Scratch& s,
                          const Capacity& capacity, const PreparedSolids& solids, const FingerOptions& parameters,
                          gpu::Timestamps* times, std::uint32_t elapsed_us) const {
  const auto count = static_cast<std::uint32_t>(solids.records.size());
  shader::ContactsPush push{
      {}, count, static_cast<float>(parameters.delta_m), capacity.points, capacity.contacts, elapsed_us, 0, 0, 0};
  if (count == 1) push.only = solids.records[0];
  const bool with_deep = parameters.wants_deep();
  const Kernel kernel = kernel_for(solids);
  const gpu::BufferRef chunks = gpu::groups_in(b.length, offsetof(shader::ScanTotal, groups_x));
  const gpu::ComputePipeline& find = find_[kernel][count == 1 ? 1 : 0][with_deep ? 1 : 0];
  Buffers buffers{b};
  if (b.reach.buffer == VK_NULL_HANDLE) buffers.reach = b.length;  // something to bind, never read
  buffers.hits = s[hits];
  buffers.masks = s[masks];
  buffers.counts = s[counts];
  buffers.deep_masks = s[deep_masks];
  buffers.deep_counts = s[deep_counts];
  buffers.surface_cells = b.surface.cells;
  buffers.surface_runs = b.surface.runs;
  buffers.surface_triangles = b.surface.triangles;
  buffers.surface_signs = b.surface.signs;
  buffers.surface_corners = b.surface.corners;
  buffers.parts_words = b.parts;
  find.dispatch_indirect(
      commands, kernel == by_planes ? spirv::contacts_find_buffers(buffers) : spirv::contacts_surface_buffers(buffers),
      push, chunks);
  gpu::compute_to_compute(commands);
  if (times) times->mark(commands, "contacts find");
  pack_.dispatch_indirect(commands, spirv::contacts_pack_buffers(buffers), push, chunks);
  if (with_deep) {
    push.most_contacts = capacity.deep;
    buffers.masks = s[deep_masks];
    buffers.counts = s[deep_counts];
    buffers.total = b.deep_total;
    buffers.contacts = b.deep;
    pack_.dispatch_indirect(commands, spirv::contacts_pack_buffers(buffers), push, chunks);
  }
  if (times) times->mark(commands, "contacts pack");
}

}  // namespace palpa::touch
