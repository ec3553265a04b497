#include "setup/target_mount.hpp"

#include <glm/ext/matrix_transform.hpp>

namespace palpa::setup {
namespace {

/// On a board with an even number of transducers along both sides, there is a gap between four transducers at every
/// whole number of pitches from the middle. The fifth is outside the stump.
constexpr double gaps = 5;
constexpr double autd3_pitch_m = 10.16e-3, square_pitch_m = 10.5e-3;

sensing::TargetHoles holes_over(const array::Board& board) {
  const double at = gaps * (board.type == "autd3" ? autd3_pitch_m : square_pitch_m);
  return {at, at};
}

/// Under the ceiling, y = 0.2 m, where four units meet.
TargetMount under_the_tunnels_ceiling() {
  TargetMount mount;
  mount.T_layout_target = Transform(Vec4(1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, -1, 0, 0), Vec4(0, 0.2, 0, 1));
  // The gaps nearest to the stump: 4 pitches from a unit's middle around the tunnel, 2 along it.
  mount.holes = {0.096 - 4 * autd3_pitch_m, 0.0757 - 2 * autd3_pitch_m};
  return mount;
}

}  // namespace

TargetMount target_mount(const array::Layout& layout) {
  if (layout.name == "paper") return under_the_tunnels_ceiling();
  if (layout.boards.empty()) return {};
  return {layout.boards.front().T_layout_board, holes_over(layout.boards.front())};
}

Transform moved_mount(const TargetMount& mount, const Vec3& origin_m, double turn_rad) {
  Transform moved = mount.T_layout_target;
  moved[3] = Vec4(origin_m, 1);
  return glm::rotate(moved, turn_rad, Vec3(0, 0, 1));
}

}  // namespace palpa::setup
