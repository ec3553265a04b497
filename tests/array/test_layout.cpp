// The built-in layouts: counts, index orders and poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "array/field/farthest.hpp"
#include "array/layouts/builtin_layouts.hpp"
#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "focus_sets.hpp"
#include "support/csv.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::array {
namespace {

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  EXPECT_LE(glm::distance(a, b), tolerance)
      << "(" << a.x << " " << a.y << " " << a.z << ") is not (" << b.x << " " << b.y << " " << b.z << ")";
}

TEST(Layout, CountsAndNames) {
  const std::vector<std::pair<std::string, std::size_t>> expected{
      {"autd3", 249}, {"paper", 3984}, {"openmpd", 256}, {"openmpd-pair", 512}, {"sonicsurface", 256}};
  std::vector<std::string> names;
  for (const auto& [name, count] : expected) {
    const Layout layout = load_layout(name);
    EXPECT_EQ(layout.transducers.size(), count) << name;
    EXPECT_EQ(layout.name, name);
    EXPECT_EQ(layout.source_level_pa_m, 4.386);
    names.push_back(name);
  }
  EXPECT_EQ(layout_names(), names);
}

TEST(Layout, AnUnknownNameListsTheKnownOnes) {
  EXPECT_REFUSED(load_layout("papre"), "papre");
  for (const std::string& name : layout_names())
    EXPECT_REFUSED(load_layout("papre"), name);
  EXPECT_REFUSED(load_layout("no/such/file.toml"), "no/such/file.toml: no such file");
  EXPECT_REFUSED(load_layout(""), "known layout");
}

TEST(Layout, Autd3IsTheUnitCentred) {
  const Layout layout = load_layout("autd3");
  // Computed from the unit's drawing: 18 x 14 at 10.16 mm, (1,1), (2,1) and (16,1) missing.
  std::size_t next = 0;
  for (int row = 0; row < 14; ++row) {
    for (int column = 0; column < 18; ++column) {
      if (row == 1 && (column == 1 || column == 2 || column == 16)) continue;
      expect_near(layout.transducers[next].position, {column * 0.01016 - 0.08636, row * 0.01016 - 0.06604, 0});
      expect_near(layout.transducers[next].axis, {0, 0, 1});
      ++next;
    }
  }
  EXPECT_EQ(next, layout.transducers.size());
}

TEST(Layout, Autd3HasTheOrderOfItsMakersTable) {
  PALPA_SHARED_OR_SKIP(file, "autd3-geometry/autd3_unit_transducers.csv");
  const auto rows = test::read_csv(file);
  const Layout layout = load_layout("autd3");
  ASSERT_EQ(rows.size(), layout.transducers.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // Columns index, gx, gy, x_mm, y_mm, z_mm; the table's origin is the first transducer.
    EXPECT_EQ(rows[i][0], static_cast<double>(i));
    expect_near(layout.transducers[i].position,
                Vec3(rows[i][3], rows[i][4], rows[i][5]) * 1e-3 - Vec3(0.08636, 0.06604, 0));
  }
}

TEST(Layout, OpenmpdCountsColumnsDownwardsAndSonicsurfaceRowsFromTheBottom) {
  const Layout openmpd = load_layout("openmpd"), sonicsurface = load_layout("sonicsurface");
  for (int row = 0; row < 16; ++row) {
    for (int column = 0; column < 16; ++column) {
      const double x = (column - 7.5) * 0.0105, y = (row - 7.5) * 0.0105;
      expect_near(openmpd.transducers[16 * column + row].position, Vec3(x, -y, 0));
      expect_near(sonicsurface.transducers[16 * row + column].position, Vec3(x, y, 0));
    }
  }
}

TEST(Layout, OpenmpdPairFacesItself) {
  const Layout layout = load_layout("openmpd-pair");
  for (int t = 0; t < 256; ++t) {
    const Vec3 low = layout.transducers[t].position;
    expect_near(layout.transducers[256 + t].position, {-low.x, low.y, 0.2388 - low.z});
    expect_near(layout.transducers[t].axis, {0, 0, 1});
    expect_near(layout.transducers[256 + t].axis, {0, 0, -1});
  }
}

TEST(Layout, PaperIsATunnelOfSixteenUnits) {
  const Layout layout = load_layout("paper");
  ASSERT_EQ(layout.boards.size(), 16u);
  const Vec3 inwards[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const Layout unit = load_layout("autd3");
  for (std::uint32_t u = 0; u < 16; ++u) {
    const Board& board = layout.boards[u];
    EXPECT_EQ(board.type, "autd3");
    EXPECT_EQ(board.first, 249 * u);
    EXPECT_EQ(board.count, 249u);
    const Vec3 x = transform_direction(board.T_layout_board, {1, 0, 0});
    const Vec3 y = transform_direction(board.T_layout_board, {0, 1, 0});
    const Vec3 z = transform_direction(board.T_layout_board, {0, 0, 1});
    const Vec3 centre = transform_point(board.T_layout_board, {0, 0, 0});
    expect_near(z, inwards[u / 4]);
    expect_near(y, {0, 0, 1});
    expect_near(x, glm::cross(y, z));
    EXPECT_NEAR(glm::dot(centre, z), -0.2, 1e-12);
    // Along the unit's own x first, then along the tunnel.
    EXPECT_NEAR(glm::dot(centre, x), (u % 2 ? 0.5 : -0.5) * 0.192, 1e-12);
    EXPECT_NEAR(centre.z, (u / 2 % 2 ? 0.5 : -0.5) * 0.1514, 1e-12);
    for (std::uint32_t t = 0; t < 249; ++t) {
      expect_near(layout.transducers[board.first + t].position,
                  transform_point(board.T_layout_board, unit.transducers[t].position));
      // Seen along the tunnel, every axis points to the tunnel's axis at a right angle, from its own height.
      const Transducer& transducer = layout.transducers[board.first + t];
      expect_near(transducer.axis, z);
      EXPECT_LT(glm::dot(Vec3(transducer.position.x, transducer.position.y, 0), transducer.axis), -0.19);
    }
  }
}

TEST(Layout, StandsBelowAndFacesUpOrIsATunnelInTheWorldsAxes) {
  for (const std::string& name : layout_names()) {
    const Layout layout = load_layout(name), world = transformed(layout, layout.default_T_world_layout);
    for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
      const auto& [p, axis] = layout.transducers[t];
      const bool tunnel = name == "paper";
      expect_near(world.transducers[t].position, tunnel ? p : Vec3(p.x, -0.15 + p.z, -p.y));
      expect_near(world.transducers[t].axis, tunnel ? axis : Vec3(axis.x, axis.z, -axis.y));
    }
    if (name == "openmpd-pair") expect_near(transform_point(world.boards[1].T_layout_board, {0, 0, 0}), {0, 0.0888, 0});
  }
}

TEST(FarthestTransducer, FindsTheFarthestTransducerOfAll) {
  EXPECT_EQ(FarthestTransducer(load_layout("paper")).candidates(), 64u);
  EXPECT_EQ(FarthestTransducer(Layout{}).distance_from({1, 2, 3}), 0);
  std::uint32_t state = 1;
  const auto next = [&state] { return ((state = state * 1664525u + 1013904223u) >> 8) / double(1 << 24) - 0.5; };
  for (const std::string& name : layout_names()) {
    Layout layout = load_layout(name);
    if (name == "autd3") {
      // Transducers without a board, before, between and after boards, are all candidates.
      layout.transducers.push_back({{0.5, 0, 0}, {0, 0, 1}});
      add_board(layout, "openmpd", Transform(1.0));
      layout.transducers.push_back({{0, -0.6, 0}, {0, 0, 1}});
    }
    const FarthestTransducer farthest(layout);
    for (int i = 0; i < 200; ++i) {
      const Vec3 from(next(), next(), next());
      EXPECT_NEAR(farthest.distance_from(from), farthest_of(layout, from), 1e-12) << name;
    }
  }
}

}  // namespace
}  // namespace palpa::array
