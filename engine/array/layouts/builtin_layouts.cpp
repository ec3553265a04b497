#include "array/layouts/builtin_layouts.hpp"

namespace palpa::array {
namespace {

Transform pose(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin) {
  return {Vec4(x, 0), Vec4(y, 0), Vec4(z, 0), Vec4(origin, 1)};
}

// AUTD3: 18 x 14 places at 10.16 mm, three of them occupied by screws and the connector; index along x first.
constexpr int autd3_columns = 18;
constexpr int autd3_rows = 14;
constexpr double autd3_pitch = 0.01016;
constexpr double autd3_width = 0.192;
constexpr double autd3_height = 0.1514;

bool autd3_missing(int x, int y) {
  return y == 1 && (x == 1 || x == 2 || x == 16);
}

void add_autd3(std::vector<Vec3>& positions) {
  for (int y = 0; y < autd3_rows; ++y) {
    for (int x = 0; x < autd3_columns; ++x) {
      if (autd3_missing(x, y)) continue;
      positions.emplace_back((x - 0.5 * (autd3_columns - 1)) * autd3_pitch, (y - 0.5 * (autd3_rows - 1)) * autd3_pitch,
                             0.0);
    }
  }
}

// The 16 x 16 boards: 10.5 mm, columns left to right, rows from the top.
constexpr int square_side = 16;
constexpr double square_pitch = 0.0105;

Vec3 square_position(int column, int row) {
  return {(column - 7.5) * square_pitch, (7.5 - row) * square_pitch, 0.0};
}

void add_openmpd(std::vector<Vec3>& positions) {
  for (int column = 0; column < square_side; ++column) {
    for (int row = 0; row < square_side; ++row)
      positions.push_back(square_position(column, row));
  }
}

void add_sonicsurface(std::vector<Vec3>& positions) {
  for (int row = 0; row < square_side; ++row) {
    for (int column = 0; column < square_side; ++column)
      positions.push_back(square_position(column, row));
  }
}

struct BoardType {
  std::string_view name;
  void (*positions)(std::vector<Vec3>&);
  double width, height;
};
constexpr BoardType boards[] = {
    {"autd3", add_autd3, autd3_width, autd3_height},
    {"openmpd", add_openmpd, square_side* square_pitch, square_side* square_pitch},
    {"sonicsurface", add_sonicsurface, square_side* square_pitch, square_side* square_pitch},
};

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
  const Vec3 up{0, 0, 1};  // each unit's y runs along the tunnel
  Layout layout;
  for (const Vec3& inwards : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    const Vec3 around = glm::cross(up, inwards);
    for (const int row : {-1, 1}) {
      for (const int column : {-1, 1}) {
        const Vec3 centre = -wall * inwards + (0.5 * autd3_width * column) * around + (0.5 * autd3_height * row) * up;
        add_board(layout, "autd3", pose(around, up, inwards, centre));
      }
    }
  }
  return layout;
}

}  // namespace

bool add_board(Layout& layout, std::string_view type, const Transform& T_layout_board) {
  for (const BoardType& known : boards) {
    if (known.name != type) continue;
    std::vector<Vec3> positions;
    known.positions(positions);
    Board board;
    board.type = type;
    board.first = static_cast<std::uint32_t>(layout.transducers.size());
    board.count = static_cast<std::uint32_t>(positions.size());
    board.width_m = known.width;
    board.height_m = known.height;
    board.T_layout_board = T_layout_board;
    layout.boards.push_back(board);
    const Vec3 axis = transform_direction(T_layout_board, {0, 0, 1});
    for (const Vec3& position : positions) {
      layout.transducers.push_back({transform_point(T_layout_board, position), axis});
    }
    return true;
  }
  return false;
}

std::vector<std::string> board_types() {
  std::vector<std::string> names;
  for (const BoardType& known : boards)
    names.emplace_back(known.name);
  return names;
}

std::optional<Layout> builtin_layout(std::string_view name) {
  Layout layout;
  if (name == "paper") {
    layout = paper_tunnel();
  } else if (name == "openmpd-pair") {
    layout = openmpd_pair();
  } else if (name == "autd3" || name == "openmpd" || name == "sonicsurface") {
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
