#include "touch/contacts/contacts_twin.hpp"

#include "shaders/touch/contacts/contacts_math.h"
#include "shaders/touch/contacts/parts_depth.h"

namespace palpa::touch {
namespace {

using shader::Float3;

bool inside(const Float3& p, const shader::vec4& low, const shader::vec4& high) {
  return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

struct Inside {
  float depth = 0;  // 0: outside, or of unknown depth
  bool shell = false;
};

Inside look(const PreparedSolids& solids, std::uint32_t solid, const Float3& point, const FingerOptions& parameters) {
  const shader::SolidRecord& record = solids.records[solid];
  const Float3 p = shader::in_solid(point, record.centre, record.turn);
  if (!inside(p, record.low, record.high)) return {};
  const float delta = record.delta > 0 ? record.delta : static_cast<float>(parameters.delta_m);
  const bool deep = parameters.wants_deep();
  if (record.asked_by == shader::asked_by_surface) {
    const geometry::Place place = geometry::find_place(solids.surfaces[solid], {p.x, p.y, p.z}, delta);
    if (place.region == geometry::Region::outside) return {};
    return {place.depth_m, place.region == geometry::Region::shell};
  }
  const std::uint32_t cell = shader::cell_of(p, record.low, record.cells_per_metre, record.cells_per_axis);
  const float depth = record.asked_by == shader::asked_by_parts
                          ? shader::parts_depth(solids.parts.data(), record.first_cell, cell, p, deep ? 3.0e38F : delta)
                          : shader::plane_cell_depth(solids.cells.data(), solids.planes.data(),
                                                     record.first_cell + cell, p, delta, deep);
  return {depth, depth > 0 && depth < delta};
}

struct Found {
  std::uint32_t solid = 0;
  float depth = 0;  // 0: neither a contact nor deep
  bool shell = false;
};

/// The first solid that the point is a contact of. If there is none and deep points are asked for, the first solid in
/// which it is a deep point.
Found find_at(const PreparedSolids& solids, const Float3& point, const FingerOptions& parameters) {
  Found found;
  for (std::uint32_t s = 0; s < solids.records.size() && !found.shell; ++s) {
    const Inside here = look(solids, s, point, parameters);
    if (here.depth == 0 || (!here.shell && (!parameters.wants_deep() || found.depth > 0))) continue;
    found = {s, here.depth, here.shell};
  }
  return found;
}

/// The finger around which the point lies, or null.
const shader::ReachingFinger* reaching_finger(const FingerReach& reach, const Float3& point) {
  if (reach.table == nullptr) return nullptr;
  const float elapsed_s = shader::seconds_of(reach.elapsed_us);
  for (std::uint32_t k = 0; k < reach.table->count; ++k) {
    if (is_around(reach.table->fingers[k], point, elapsed_s)) return &reach.table->fingers[k];
  }
  return nullptr;
}

}  // namespace

void find_contacts(std::span<const sensing::SkinPoint> points, const PreparedSolids& solids,
                   const FingerOptions& parameters, const FingerReach& reach, Touch& out) {
  out.contacts.clear();
  out.deep.clear();
  for (const sensing::SkinPoint& skin : points) {
    const Float3 point{skin.position.x, skin.position.y, skin.position.z};
    if (!shader::is_finite(point.x) || !shader::is_finite(point.y) || !shader::is_finite(point.z)) continue;
    Found found = find_at(solids, point, parameters);
    bool beyond = false;
    if (const shader::ReachingFinger* finger = found.shell ? nullptr : reaching_finger(reach, point)) {
      for (const bool deeper : {true, false}) {
        const Found there = find_at(solids, shader::shifted(point, finger->inward, deeper), parameters);
        if (!there.shell || there.solid != finger->solid) continue;
        found = there;
        beyond = true;
        break;
      }
    }
    if (found.depth == 0) continue;
    (found.shell ? out.contacts : out.deep)
        .push_back({skin.index, found.solid, found.depth, skin.position, beyond ? 1U : 0U});
  }
}

}  // namespace palpa::touch
