#include "array/layouts/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "array/layouts/board_mesh.hpp"
#include "array/layouts/builtin_layouts.hpp"
#include "array/layouts/layout_toml.hpp"
#include "base/error.hpp"

namespace palpa::array {

std::vector<std::string> layout_names() {
  return {"autd3", "paper", "openmpd", "openmpd-pair", "sonicsurface"};
}

std::string known_layouts() {
  return fmt::format("{}", fmt::join(layout_names(), ", "));
}

Layout load_layout(const std::string& name_or_file) {
  if (auto layout = builtin_layout(name_or_file)) return *std::move(layout);
  std::error_code ignored;
  const bool looks_like_file = name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".toml") ||
                               std::filesystem::exists(name_or_file, ignored);
  if (!looks_like_file) {
    throw bad_input(name_or_file, fmt::format("neither a file nor a known layout; known: {}", known_layouts()));
  }
  return load_layout_toml(name_or_file);
}

bool is_layout(const std::string& name_or_file) {
  std::error_code ignored;
  return std::ranges::count(layout_names(), name_or_file) > 0 || std::filesystem::exists(name_or_file, ignored);
}

Layout transformed(const Layout& layout, const Transform& T_world_layout) {
  Layout world = layout;
  for (Transducer& transducer : world.transducers) {
    transducer.position = transform_point(T_world_layout, transducer.position);
    transducer.axis = transform_direction(T_world_layout, transducer.axis);
  }
  for (Board& board : world.boards)
    board.T_layout_board = T_world_layout * board.T_layout_board;
  // Its coordinates are already world coordinates.
  world.default_T_world_layout = Transform(1.0);
  return world;
}

geometry::Mesh board_mesh(const Layout& layout) {
  geometry::Mesh mesh;
  for (const Board& board : layout.boards) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const double x = 0.5 * board.width_m;
    const double y = 0.5 * board.height_m;
    for (const Vec3& corner : {Vec3(-x, -y, 0), Vec3(x, -y, 0), Vec3(x, y, 0), Vec3(-x, y, 0)}) {
      mesh.positions.push_back(transform_point(board.T_layout_board, corner));
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
  }
  return mesh;
}

}  // namespace palpa::array
