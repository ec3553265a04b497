#include "array/layouts/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <mutex>
#include <numeric>
#include <tuple>

#include "array/layouts/board_mesh.hpp"
#include "array/layouts/builtin_layouts.hpp"
#include "array/layouts/layout_toml.hpp"
#include "array/medium.hpp"
#include "base/error.hpp"

namespace palpa::array {

std::vector<std::string> layout_names() {
  return builtin_layout_names();
}

std::string known_layouts() {
  return fmt::format("{}", fmt::join(layout_names(), ", "));
}

namespace {

/// Layouts of KnownLayout, by their names.
struct Known {
  std::mutex mutex;
  std::map<std::string, Layout> layouts;
  std::uint64_t count = 0;
};
Known& known() {
  static auto* const instance = new Known();  // used until the process ends
  return *instance;
}

}  // namespace

KnownLayout::KnownLayout(Layout layout) {
  const std::lock_guard lock(known().mutex);
  name_ = fmt::format("{} (made {})", layout.name, ++known().count);
  known().layouts.emplace(name_, std::move(layout));
}

KnownLayout::~KnownLayout() {
  const std::lock_guard lock(known().mutex);
  known().layouts.erase(name_);
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> coinciding(const std::vector<Transducer>& transducers) {
  std::vector<std::uint32_t> order(transducers.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    const Vec3& p = transducers[i].position;
    return std::tuple(p.x, p.y, p.z, i);
  };
  std::ranges::sort(order, {}, key);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (transducers[order[i - 1]].position == transducers[order[i]].position) return std::pair(order[i - 1], order[i]);
  }
  return std::nullopt;
}

Layout checked(Layout layout) {
  const auto in_range = [](const char* what, double value, double most) {
    if (value > 0 && value <= most) return;
    throw bad_usage(fmt::format("a layout's {} is {}; it must be above 0 and at most {}", what, value, most));
  };
  in_range("source level", layout.source_level_pa_m, most_source_level_pa_m);
  in_range("transducer radius", layout.transducer_radius_m, most_transducer_radius_m);
  if (!(layout.frequency_hz >= least_frequency && layout.frequency_hz <= most_frequency)) {
    throw bad_usage(fmt::format("a layout's frequency is {} Hz; it must be from {} to {} Hz", layout.frequency_hz,
                                least_frequency, most_frequency));
  }
  const std::size_t count = layout.transducers.size();
  if (count == 0 || count > max_transducers)
    throw bad_usage(fmt::format("a layout has 1 to {} transducers, not {}", max_transducers, count));
  for (std::size_t i = 0; i < count; ++i) {
    auto& [position, axis] = layout.transducers[i];
    for (int a = 0; a < 3; ++a) {
      if (!(std::abs(position[a]) <= most_layout_m)) {
        throw bad_usage(
            fmt::format("transducer {} has a coordinate of {} m; the limit is {} m", i, position[a], most_layout_m));
      }
    }
    const double length = glm::length(axis);
    if (!(std::abs(length - 1) <= axis_tolerance))
      throw bad_usage(fmt::format("the axis of transducer {} has length {}, not 1", i, length));
    axis /= length;
  }
  if (const auto pair = coinciding(layout.transducers))
    throw bad_usage(fmt::format("transducers {} and {} are at the same place", pair->first, pair->second));
  return layout;
}

Layout load_layout(const std::string& name_or_file) {
  {
    const std::lock_guard lock(known().mutex);
    if (const auto found = known().layouts.find(name_or_file); found != known().layouts.end()) return found->second;
  }
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
  {
    const std::lock_guard lock(known().mutex);
    if (known().layouts.contains(name_or_file)) return true;
  }
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
