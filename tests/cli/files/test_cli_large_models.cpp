// The cost of large models is bounded by their size, too. PALPA_EXHAUSTIVE tests models near the limits; other runs
// test models of at most a tenth of that size.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "cli/support/cost.hpp"
#include "geometry/hostile_models.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"

namespace palpa::test {
namespace {

using geometry::Mesh;
using hostile::needles, hostile::nested, hostile::rods;

class LargeModels : public Cost {
 protected:
  const bool all_ = std::getenv("PALPA_EXHAUSTIVE") != nullptr;
};

TEST_F(LargeModels, OfAMillionTriangles) {
  if (instrumented()) GTEST_SKIP() << "skipped: a sanitizer changes the use of memory";
  const int rings = all_ ? 700 : 150;
  Mesh ball = sphere(0.05, rings, rings);
  for (Vec3& p : ball.positions)
    p *= 1 + 0.1 * std::sin(120 * p.x) * std::sin(130 * p.y);
  EXPECT_EQ(touch(ball).exit_code, 0);
}

TEST_F(LargeModels, OfWhatASyntheticSourceRenders) {
  if (instrumented()) GTEST_SKIP() << "skipped: rays are too slow with a sanitizer";
  EXPECT_EQ(rendered(nested(all_ ? 4001 : 401, true)).exit_code, 0);
  EXPECT_EQ(rendered(rods(all_ ? 8000 : 800)).exit_code, 0);
  const auto expect_too_many = [&](std::uint32_t count) {
    expect_failure(rendered(needles(count)), 4, "model.glb: camera \"front left\" sees so many of its triangles");
  };
  expect_too_many(5000);
  if (all_) expect_too_many(50'000);
}

}  // namespace
}  // namespace palpa::test
