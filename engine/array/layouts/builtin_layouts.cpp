#include "array/layouts/builtin_layouts.hpp"

#include "array/layouts/board_types.hpp"

namespace palpa::array {
namespace {

Transform pose(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin) {
  return {Vec4(x, 0), Vec4(y, 0), Vec4(z, 0), Vec4(origin, 1)};
}

Layout one_board(std::string_view type) {
  Layout layout;
  add_board(layout, type, Transform(1.0));
  layout.default_T_world_layout = below_facing_up();
  return layout;
}

Layout openmpd_pair() {
  Layout layout = one_board("openmpd");
  add_board(layout, "openmpd", pose({-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 0.2388}));
  return layout;
}

// A reconstruction: the paper only says that the units surround the workspace. 2 x 2 units fit on a wall of 400 mm with
// 8 mm to spare at each corner.
Layout paper_tunnel() {
  constexpr double wall = 0.2;
  const BoardType& unit = *find_board_type("autd3");
  const Vec3 up{0, 0, 1};  // each unit's y runs along the tunnel
  Layout layout;
  layout.amplitude_law = Weighting::distance;  // the paper's q_k
  for (const Vec3& inwards : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    const Vec3 around = glm::cross(up, inwards);
    for (const int row : {-1, 1}) {
      for (const int column : {-1, 1}) {
        const Vec3 centre = -wall * inwards + (0.5 * unit.width_m * column) * around + (0.5 * unit.height_m * row) * up;
        add_board(layout, "autd3", pose(around, up, inwards, centre));
      }
    }
  }
  return layout;
}

}  // namespace

bool add_board(Layout& layout, std::string_view type, const Transform& T_layout_board) {
  const BoardType* const known = find_board_type(type);
  if (known == nullptr) return false;
  std::vector<Vec3> places;
  known->add_places(places);
  Board board;
  board.type = type;
  board.first = static_cast<std::uint32_t>(layout.transducers.size());
  board.count = static_cast<std::uint32_t>(places.size());
  board.width_m = known->width_m;
  board.height_m = known->height_m;
  board.T_layout_board = T_layout_board;
  layout.boards.push_back(board);
  const Vec3 axis = transform_direction(T_layout_board, {0, 0, 1});
  for (const Vec3& place : places)
    layout.transducers.push_back({transform_point(T_layout_board, place), axis});
  return true;
}

std::vector<std::string> builtin_layout_names() {
  std::vector<std::string> names;
  for (const BoardType& type : board_types()) {
    names.emplace_back(type.name);
    if (type.name == "autd3") names.emplace_back("paper");
    if (type.name == "openmpd") names.emplace_back("openmpd-pair");
  }
  return names;
}

std::optional<Layout> builtin_layout(std::string_view name) {
  Layout layout;
  if (name == "paper") {
    layout = paper_tunnel();
  } else if (name == "openmpd-pair") {
    layout = openmpd_pair();
  } else if (find_board_type(name) != nullptr) {
    layout = one_board(name);
  } else {
    return std::nullopt;
  }
  layout.name = name;
  return layout;
}

Transform below_facing_up() {
  return pose({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, -0.15, 0});
}

}  // namespace palpa::array
