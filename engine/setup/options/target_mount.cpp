#include "setup/options/target_mount.hpp"

#include <glm/ext/matrix_transform.hpp>
#include <string_view>

#include "array/layouts/board_types.hpp"

namespace palpa::setup {
namespace {

/// On a board with an even number of transducers along both sides, there is a gap between four transducers at every
/// whole number of pitches from the middle. The fifth is outside the stump.
constexpr double gaps = 5;

double pitch_of(std::string_view type) {
  return array::find_board_type(type)->pitch_m;
}

sensing::TargetHoles holes_over(const array::Board& board) {
  const double at = gaps * pitch_of(board.type);
  return {at, at};
}

/// Under the ceiling, y = 0.2 m, where four units meet.
TargetMount under_the_tunnels_ceiling() {
  TargetMount mount;
  mount.T_layout_target = Transform(Vec4(1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, -1, 0, 0), Vec4(0, 0.2, 0, 1));
  // The gaps nearest to the stump: 4 pitches from a unit's middle around the tunnel, 2 along it.
  const double pitch_m = pitch_of("autd3");
  mount.holes = {0.096 - 4 * pitch_m, 0.0757 - 2 * pitch_m};
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
