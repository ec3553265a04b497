#include "touch/contacts.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "gpu/barrier.hpp"
#include "shaders/parts_depth.h"
#include "shaders/touch_math.h"
#include "spirv/contacts_find.comp.hpp"
#include "spirv/contacts_pack.comp.hpp"
#include "spirv/contacts_surface.comp.hpp"

namespace palpa::touch {
namespace {

using shader::Float3;

bool inside(const Float3& p, const shader::vec4& low, const shader::vec4& high) {
  return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

/// Eq. (1)'s depth below the nearest plane, 0 outside.
float plane_depth(const SceneTable& table, std::uint32_t solid, const Float3& p) {
  float depth = 3.0e38F;
  for (std::uint32_t m = table.first_plane[solid]; m < table.first_plane[solid + 1] && depth > 0; ++m) {
    const shader::vec4& plane = table.planes[m];
    const float d = shader::plane_depth({plane.x, plane.y, plane.z}, plane.w, p);
    depth = d < depth ? d : depth;
  }
  return depth > 0 ? depth : 0;
}

struct Inside {
  float depth = 0;  // 0: outside, or of unknown depth
  bool shell = false;
};

Inside look(const SceneTable& table, std::uint32_t solid, const Float3& point, const Parameters& parameters) {
  const shader::SolidRecord& record = table.solids[solid];
  const Float3 p = shader::turned({record.centre.w, record.low.w, record.high.w}, record.cells_per_metre.w,
                                  shader::minus(point, {record.centre.x, record.centre.y, record.centre.z}));
  if (!inside(p, record.low, record.high)) return {};
  const float delta = record.delta > 0 ? record.delta : static_cast<float>(parameters.delta_m);
  if (record.by_surface == shader::asked_by_parts) {
    const std::uint32_t cell = shader::parts_cell(
        p, {record.low.x, record.low.y, record.low.z},
        {record.cells_per_metre.x, record.cells_per_metre.y, record.cells_per_metre.z}, record.cells_per_axis);
    const float depth =
        shader::parts_depth(table.parts.data(), record.first_cell, cell, p, parameters.wants_deep() ? 3.0e38F : delta);
    return {depth, depth > 0 && depth < delta};
  }
  if (record.by_surface != 0) {
    const geometry::Place place = geometry::find_place(table.surfaces[solid], {p.x, p.y, p.z}, delta);
    if (place.region == geometry::Region::outside) return {};
    return {place.depth_m, place.region == geometry::Region::shell};
  }
  const float depth = plane_depth(table, solid, p);
  return {depth, depth > 0 && depth < delta};
}

}  // namespace

void find_contacts(std::span<const sensing::SkinPoint> points, const SceneTable& table, const Parameters& parameters,
                   Touch& out) {
  out.contacts.clear();
  out.deep.clear();
  for (const sensing::SkinPoint& skin : points) {
    const Float3 point{skin.position.x, skin.position.y, skin.position.z};
    if (!shader::is_finite(point.x) || !shader::is_finite(point.y) || !shader::is_finite(point.z)) continue;
    Contact found{skin.index, 0, 0, skin.position};
    bool shell = false;
    for (std::uint32_t s = 0; s < table.solids.size() && !shell; ++s) {
      const Inside here = look(table, s, point, parameters);
      shell = here.shell;
      if (here.depth == 0 || (!shell && (!parameters.wants_deep() || found.depth_m > 0))) continue;
      found.solid = s;
      found.depth_m = here.depth;
    }
    if (found.depth_m == 0) continue;
    (shell ? out.contacts : out.deep).push_back(found);
  }
}

std::uint32_t mask_words(std::uint32_t points) {
  constexpr std::uint32_t round_of_all = shader::contacts_chunks * shader::contacts_group;
  return gpu::groups_for(points, round_of_all) * round_of_all / 32;
}

ContactsPass::ContactsPass(const gpu::Device& device)
    : pack_(device, "contacts pack", spirv::contacts_pack_comp,
            {shader::contacts_pack_buffers, sizeof(shader::ContactsPush)}) {
  for (std::uint32_t one = 0; one < 2; ++one) {
    for (std::uint32_t deep = 0; deep < 2; ++deep) {
      const auto surface = [&](const char* name, std::uint32_t parts) {
        const std::array<std::uint32_t, 3> constants{one, deep, parts};
        return gpu::ComputePipeline(device, name, spirv::contacts_surface_comp,
                                    {shader::contacts_surface_buffers, sizeof(shader::ContactsPush), constants,
                                     shader::contacts_surface_texels});
      };
      const std::array<std::uint32_t, 2> constants{one, deep};
      find_[one][deep] = {{device,
                           "contacts find",
                           spirv::contacts_find_comp,
                           {shader::contacts_find_buffers, sizeof(shader::ContactsPush), constants}},
                          surface("contacts surface", 0),
                          surface("contacts parts", 1)};
    }
  }
}

void ContactsPass::record(VkCommandBuffer commands, const ContactsBuffers& b, const SceneTable& table,
                          const Parameters& parameters, gpu::Timestamps* times) const {
  assert(b.most_points <= shader::contacts_most_points);
  const auto solids = static_cast<std::uint32_t>(table.solids.size());
  shader::ContactsPush push{{}, solids, static_cast<float>(parameters.delta_m), b.most_points, b.most_contacts};
  if (solids == 1) push.only = table.solids[0];
  const bool deep = parameters.wants_deep();
  const Kernels& find = find_[solids == 1 ? 1 : 0][deep ? 1 : 0];
  // Nothing is written there where deep points are not asked for.
  const gpu::BufferRef deep_masks = deep ? b.deep_masks : b.masks;
  const gpu::BufferRef deep_counts = deep ? b.deep_counts : b.counts;
  const auto asked_by = [&](std::uint32_t kind) {
    return std::any_of(table.solids.begin(), table.solids.end(),
                       [&](const shader::SolidRecord& solid) { return solid.by_surface == kind; });
  };
  const bool by_parts = asked_by(shader::asked_by_parts);
  if (by_parts || asked_by(shader::asked_by_surface)) {
    (by_parts ? find.parts : find.surface)
        .dispatch(commands,
                  {b.points, b.length, b.hits, b.masks, b.counts, b.solids, b.cells, b.planes, deep_masks, deep_counts,
                   b.surface.cells, b.surface.runs, b.surface.triangles, b.surface.signs, b.surface.corners, b.parts},
                  push, shader::contacts_chunks);
  } else {
    find.planes.dispatch(
        commands, {b.points, b.length, b.hits, b.masks, b.counts, b.solids, b.cells, b.planes, deep_masks, deep_counts},
        push, shader::contacts_chunks);
  }
  gpu::compute_to_compute(commands);
  if (times) times->mark(commands, "contacts find");
  pack_.dispatch(commands, {b.points, b.length, b.hits, b.masks, b.counts, b.total, b.contacts}, push,
                 shader::contacts_chunks);
  if (deep) {
    push.most_contacts = b.most_deep;
    pack_.dispatch(commands, {b.points, b.length, b.hits, b.deep_masks, b.deep_counts, b.deep_total, b.deep}, push,
                   shader::contacts_chunks);
  }
  if (times) times->mark(commands, "contacts pack");
}

}  // namespace palpa::touch
