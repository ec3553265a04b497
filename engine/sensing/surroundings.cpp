#include "sensing/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

namespace palpa::sensing {
namespace {

/// More than the rounding errors of the kernel's float arithmetic on coordinates of a few metres.
constexpr double slack_m = 1e-5;

/// In the slab's own frame.
Box box_of(const Slab& slab) {
  return {Vec3(-slab.width_m / 2, -slab.height_m / 2, -slab_behind_m),
          Vec3(slab.width_m / 2, slab.height_m / 2, slab_before_m)};
}

/// The box around a box that is moved.
Box moved(const Transform& T, const Box& box) {
  Box out;
  for (const Vec3& corner : box.corners())
    out.add(transform_point(T, corner));
  return out;
}

bool contains(const Box& outer, const Box& inner) {
  for (int i = 0; i < 3; ++i) {
    if (inner.low[i] < outer.low[i] + slack_m || inner.high[i] > outer.high[i] - slack_m) return false;
  }
  return true;
}

shader::vec4 corner_of(const Vec3& corner) {
  return {static_cast<float>(corner.x), static_cast<float>(corner.y), static_cast<float>(corner.z), 0};
}

/// Cuts a convex polygon with the half space where `sign` times coordinate `axis` is at most `limit`.
void cut(std::vector<Vec3>& polygon, std::vector<Vec3>& scratch, int axis, double sign, double limit) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double out_a = sign * a[axis] - limit, out_b = sign * b[axis] - limit;
    if (out_a <= 0) scratch.push_back(a);
    if ((out_a <= 0) != (out_b <= 0)) scratch.push_back(a + (b - a) * (out_a / (out_a - out_b)));
  }
  std::swap(polygon, scratch);
}

}  // namespace

Surroundings surroundings_of(const Rig& rig) {
  Surroundings all;
  if (rig.screen)
    all.slabs.push_back({NoSkin::screen, rig.screen->width_m, rig.screen->height_m, rig.screen->T_world_screen});
  if (rig.room) all.room = rig.room->box;
  return all;
}

std::size_t most_drops(const Surroundings& surroundings) {
  return surroundings.slabs.size() + (surroundings.room ? 1 : 0);
}

void plan_drops(const Surroundings& surroundings, const Box& box, std::vector<shader::SkinVolume>& out) {
  out.clear();
  if (box.empty()) return;
  if (surroundings.room && !contains(*surroundings.room, box)) {
    shader::SkinVolume volume{};
    volume.x = corner_of(surroundings.room->low);
    volume.y = corner_of(surroundings.room->high);
    volume.kind = shader::skin_room;
    out.push_back(volume);
  }
  for (const Slab& slab : surroundings.slabs) {
    const Box own = box_of(slab);
    if (!moved(slab.T_world_slab, own).overlaps(box, slack_m)) continue;
    const Transform T_slab_world = glm::inverse(slab.T_world_slab);
    if (!moved(T_slab_world, box).overlaps(own, slack_m)) continue;
    shader::SkinVolume volume{};
    volume.x = row_of(T_slab_world, 0);
    volume.y = row_of(T_slab_world, 1);
    volume.z = row_of(T_slab_world, 2);
    volume.half_width = static_cast<float>(slab.width_m / 2);
    volume.half_height = static_cast<float>(slab.height_m / 2);
    volume.kind = static_cast<std::uint32_t>(slab.kind);
    out.push_back(volume);
  }
}

bool reaches_into(const geometry::Mesh& mesh, const Slab& slab) {
  const Box own = box_of(slab);
  const Box around = moved(slab.T_world_slab, own);
  if (!geometry::bounds(mesh).overlaps(around)) return false;
  const Transform T_slab_world = glm::inverse(slab.T_world_slab);
  std::vector<Vec3> polygon, scratch;
  for (const glm::uvec3& corners : mesh.triangles) {
    Box triangle;
    for (int i = 0; i < 3; ++i)
      triangle.add(mesh.positions[corners[i]]);
    if (!triangle.overlaps(around)) continue;
    polygon.clear();
    for (int i = 0; i < 3; ++i)
      polygon.push_back(transform_point(T_slab_world, mesh.positions[corners[i]]));
    for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
      cut(polygon, scratch, axis, 1, own.high[axis]);
      if (!polygon.empty()) cut(polygon, scratch, axis, -1, -own.low[axis]);
    }
    if (!polygon.empty()) return true;
  }
  return false;
}

}  // namespace palpa::sensing
