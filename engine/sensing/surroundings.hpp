// What a camera sees that is no skin, as far as the rig knows it: the array's boards, the screen, and everything
// outside the room. What one camera knows of the place where it stands, its background, is in camera.hpp. Metres,
// world.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/no_skin.hpp"
#include "sensing/rig.hpp"
#include "shaders/sensing/skin.h"

namespace palpa::sensing {

/// A rectangle in the plane z = 0 of its own frame, centred on the origin, with its face towards +z. Points over the
/// rectangle, from `slab_before_m` before its face to `slab_behind_m` behind it, are no skin: a board has electronics
/// behind it, and a camera's noise before it.
struct Slab {
  NoSkin kind = NoSkin::board;
  double width_m = 0, height_m = 0;  ///< along its x and y
  Transform T_world_slab{1.0};       ///< rigid
};
inline constexpr double slab_before_m = 8e-3, slab_behind_m = 50e-3;
static_assert(static_cast<float>(slab_before_m) == shader::skin_before_m &&
              static_cast<float>(slab_behind_m) == shader::skin_behind_m);
static_assert(static_cast<std::uint32_t>(NoSkin::room) == shader::skin_room &&
              static_cast<std::uint32_t>(NoSkin::board) == shader::skin_board &&
              static_cast<std::uint32_t>(NoSkin::screen) == shader::skin_screen &&
              static_cast<std::uint32_t>(NoSkin::background) == shader::skin_background);

struct Surroundings {
  std::vector<Slab> slabs;
  std::optional<Box> room;  ///< points outside are no skin

  bool empty() const { return slabs.empty() && !room; }
};

/// The screen and the room of a rig; its boards are known to those who know its layout.
Surroundings surroundings_of(const Rig& rig);

/// Replaces `out` by those parts of the surroundings that can hold points of `box` (world), in the form that SkinPass
/// and its twin take; the room first, then the slabs in their order. Conservative: whatever is left out drops no point
/// of the box. If `out` is empty, finding skin costs the same as without surroundings. Allocates nothing once `out` has
/// room for all of them.
void plan_drops(const Surroundings& surroundings, const Box& box, std::vector<shader::SkinVolume>& out);
/// The maximum length of that list.
std::size_t most_drops(const Surroundings& surroundings);

/// Whether points on the mesh's surface (world) can lie in the slab.
bool reaches_into(const geometry::Mesh& mesh, const Slab& slab);

/// A row of a transform, for a kernel.
inline shader::vec4 row_of(const Transform& T, int row) {
  return {static_cast<float>(T[0][row]), static_cast<float>(T[1][row]), static_cast<float>(T[2][row]),
          static_cast<float>(T[3][row])};
}

}  // namespace palpa::sensing
