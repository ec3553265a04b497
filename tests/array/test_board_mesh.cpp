// The boards as rectangles: sizes and facing.
#include <gtest/gtest.h>

#include "array/layouts/board_mesh.hpp"

namespace palpa::array {
namespace {

Vec3 area(const geometry::Mesh& mesh, std::size_t triangle) {
  const glm::uvec3 t = mesh.triangles[triangle];
  return 0.5 * glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
}

TEST(BoardMesh, OneRectanglePerBoardFacingWhereItSounds) {
  for (const std::string& name : layout_names()) {
    const Layout layout = load_layout(name);
    const geometry::Mesh mesh = board_mesh(layout);
    ASSERT_EQ(mesh.triangles.size(), 2 * layout.boards.size()) << name;
    ASSERT_EQ(mesh.positions.size(), 4 * layout.boards.size()) << name;
    for (std::size_t b = 0; b < layout.boards.size(); ++b) {
      const Board& board = layout.boards[b];
      const bool autd3 = board.type == "autd3";
      EXPECT_EQ(board.width_m, autd3 ? 0.192 : 0.168);
      EXPECT_EQ(board.height_m, autd3 ? 0.1514 : 0.168);
      const Vec3 both = area(mesh, 2 * b) + area(mesh, 2 * b + 1);
      EXPECT_LE(glm::distance(both, board.width_m * board.height_m * layout.transducers[board.first].axis), 1e-12);
      // Every transducer lies on it.
      Box box;
      for (int corner = 0; corner < 4; ++corner)
        box.add(mesh.positions[4 * b + corner]);
      for (std::uint32_t t = board.first; t < board.first + board.count; ++t) {
        const Vec3 p = layout.transducers[t].position;
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GE(p[axis], box.low[axis] - 1e-12);
          EXPECT_LE(p[axis], box.high[axis] + 1e-12);
        }
      }
    }
  }
}

TEST(BoardMesh, BareTransducersHaveNone) {
  Layout layout;
  layout.transducers.push_back({{0, 0, 0}, {0, 0, 1}});
  EXPECT_TRUE(board_mesh(layout).triangles.empty());
}

}  // namespace
}  // namespace palpa::array
