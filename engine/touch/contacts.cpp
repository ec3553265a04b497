#include "touch/contacts.hpp"

#include <cassert>

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

constexpr std::uint32_t one_solid = 1;

}  // namespace

void find_contacts(std::span<const sensing::SkinPoint> points, const PlaneTable& table, double delta_m,
                   std::vector<Contact>& out) {
  out.clear();
  const auto delta = static_cast<float>(delta_m);
  for (const sensing::SkinPoint& skin : points) {
    const Float3 point{skin.position.x, skin.position.y, skin.position.z};
    if (!shader::is_finite(point.x) || !shader::is_finite(point.y) || !shader::is_finite(point.z)) continue;
    for (std::uint32_t s = 0; s < table.solids.size(); ++s) {
      const float depth = shell_depth(table, s, point, delta);
      if (depth == 0) continue;
      out.push_back({skin.index, s, depth, skin.position});
      break;
    }
  }
}

std::uint32_t mask_words(std::uint32_t points) {
  constexpr std::uint32_t round_of_all = shader::contacts_chunks * shader::contacts_group;
  return gpu::groups_for(points, round_of_all) * round_of_all / 32;
}

ContactsPass::ContactsPass(const gpu::Device& device)
    : find_(device, "contacts find", spirv::contacts_find_comp,
            {shader::contacts_find_buffers, sizeof(shader::ContactsPush)}),
      find_one_(device, "contacts find one", spirv::contacts_find_comp,
                {shader::contacts_find_buffers, sizeof(shader::ContactsPush), {&one_solid, 1}}),
      pack_(device, "contacts pack", spirv::contacts_pack_comp,
            {shader::contacts_pack_buffers, sizeof(shader::ContactsPush)}) {}

void ContactsPass::record(VkCommandBuffer commands, const ContactsBuffers& b, const PlaneTable& table, double delta_m,
                          gpu::Timestamps* times) const {
  assert(b.most_points <= shader::contacts_most_points);
  const auto solids = static_cast<std::uint32_t>(table.solids.size());
  shader::ContactsPush push{{}, solids, static_cast<float>(delta_m), b.most_points, b.most_contacts};
  if (solids == 1) push.only = table.solids[0];
  const gpu::ComputePipeline& find = solids == 1 ? find_one_ : find_;
  find.dispatch(commands, {b.points, b.length, b.hits, b.masks, b.counts, b.solids, b.cells, b.planes}, &push,
                shader::contacts_chunks);
  gpu::compute_to_compute(commands);
  if (times) times->mark(commands, "contacts find");
  pack_.dispatch(commands, {b.points, b.length, b.hits, b.masks, b.counts, b.total, b.contacts}, &push,
                 shader::contacts_chunks);
  if (times) times->mark(commands, "contacts pack");
}

}  // namespace palpa::touch
