#include "touch/contacts.hpp"

#include "gpu/barrier.hpp"
#include "shaders/touch_math.h"
#include "spirv/contacts_find.comp.hpp"
#include "spirv/contacts_pack.comp.hpp"

namespace palpa::touch {
namespace {

using shader::Float3;

bool inside(const Float3& p, const shader::vec4& low, const shader::vec4& high) {
  return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

/// Eq. (1)'s depth below the nearest plane if it is in (0, delta), else 0.
float shell_depth(const PlaneTable& table, std::size_t solid, const Float3& point, float delta) {
  const shader::SolidRecord& record = table.solids[solid];
  const Float3 p = shader::minus(point, {record.centre.x, record.centre.y, record.centre.z});
  if (!inside(p, record.low, record.high)) return 0;
  float depth = 3.0e38F;
  for (std::uint32_t m = table.first_plane[solid]; m < table.first_plane[solid + 1] && depth > 0; ++m) {
    const shader::vec4& plane = table.planes[m];
    const float d = shader::plane_depth({plane.x, plane.y, plane.z}, plane.w, p);
    depth = d < depth ? d : depth;
  }
  return depth > 0 && depth < delta ? depth : 0;
}

}  // namespace

void find_contacts(std::span<const sensing::SkinPoint> points, const PlaneTable& table, double delta_m,
                   std::vector<Contact>& out) {
  out.clear();
  const auto delta = static_cast<float>(delta_m);
  for (const sensing::SkinPoint& skin : points) {
    const Float3 point{skin.position.x, skin.position.y, skin.position.z};
    if (!shader::is_finite(point.x) || !shader::is_finite(point.y) || !shader::is_finite(point.z)) continue;
    if (!inside(point, table.low, table.high)) continue;
    for (std::uint32_t s = 0; s < table.solids.size(); ++s) {
      const float depth = shell_depth(table, s, point, delta);
      if (depth == 0) continue;
      out.push_back({skin.index, s, depth, skin.position});
      break;
    }
  }
}

ContactsPass::ContactsPass(const gpu::Device& device)
    : find_(device, "contacts find", spirv::contacts_find_comp,
            {shader::contacts_find_buffers, sizeof(shader::ContactsPush)}),
      pack_(device, "contacts pack", spirv::contacts_pack_comp,
            {shader::contacts_pack_buffers, sizeof(shader::ContactsPush)}),
      scan_(device) {}

void ContactsPass::record(VkCommandBuffer commands, const ContactsBuffers& buffers, const PlaneTable& table,
                          double delta_m) const {
  const shader::ContactsPush push{table.low,
                                  table.high,
                                  static_cast<std::uint32_t>(table.solids.size()),
                                  static_cast<float>(delta_m),
                                  buffers.most_points,
                                  buffers.most_contacts};
  const gpu::BufferRef groups{buffers.length.buffer, buffers.length.offset + offsetof(shader::ScanTotal, groups_x),
                              sizeof(VkDispatchIndirectCommand)};
  find_.dispatch_indirect(
      commands,
      {buffers.points, buffers.length, buffers.hits, buffers.counts, buffers.solids, buffers.cells, buffers.planes},
      &push, groups);
  gpu::compute_to_compute(commands);
  scan_.record(commands, buffers.counts, buffers.length, buffers.total,
               {.most_counts = gpu::groups_for(buffers.most_points, shader::contacts_group),
                .items_per_count = shader::contacts_group,
                .most_total = buffers.most_points});
  gpu::compute_to_compute(commands);
  pack_.dispatch_indirect(
      commands, {buffers.points, buffers.length, buffers.hits, buffers.counts, buffers.total, buffers.contacts}, &push,
      groups);
}

}  // namespace palpa::touch
