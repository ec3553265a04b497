// `palpa scatter`, called from C++.
#include "setup/tasks/scatter.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "array/layouts/layout.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

TEST(ScatterTask, RefusesSoundsAndBodiesOutOfRange) {
  const geometry::Mesh mesh =
      transformed(geometry::icosphere(3e-3, 3), [](const Vec3& p) { return p + Vec3(0, 0, 0.1); });
  const acoustics::Air air = acoustics::without_absorption(setup::air({}, {}));
  const array::Layout layout = array::load_layout("openmpd");
  const auto refused = [&](const setup::IncidentSound& sound, const acoustics::Air& in, std::vector<Vec3> points,
                           const char* part) {
    EXPECT_ERROR(setup::scatter("ball", mesh, sound, in, points), Exit::usage, part);
  };
  refused(setup::PlaneWave{}, air, {}, "a plane wave needs a direction whose length is not 0");
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    for (const double side : {-1, 1}) {
      refused(setup::PointSource{side * 1.0001e4 * axis}, air, {}, "the point source is not within 10000 m");
      refused(setup::PlaneWave{{0, 0, 1}}, air, {side * 100.1 * axis}, "is not within 100 m");
    }
  }
  refused(setup::PointSource{{0, 0, 0.1}}, air, {}, "lies inside the mesh");
  refused(setup::ArraySound{layout, array::Drive(3)}, air, {}, "it has 3 transducers, but openmpd has 256");
  refused(setup::PlaneWave{{0, 0, 1}}, setup::air({}, {}), {}, "computed in lossless air");
  refused(setup::PlaneWave{{0, 0, 1}}, air, {{0, 0, 200}}, "point 0, (0, 0, 200) is not within 100 m");
  const geometry::Mesh open{{{0, 0, 0.1}, {1e-3, 0, 0.1}, {0, 1e-3, 0.1}}, {{0, 1, 2}}};
  EXPECT_REFUSED(setup::scatter("the sheet", open, setup::PlaneWave{{0, 0, 1}}, air), "the sheet: ");
  geometry::Mesh torn = mesh;
  torn.triangles[5].y = 1000000;
  EXPECT_REFUSED(setup::scatter("the ball", torn, setup::PlaneWave{{0, 0, 1}}, air),
                 "the ball: triangle 5 names vertex 1000000, but there are only");
  refused(setup::ArraySound{array::Layout{}, {}}, air, {}, "has no transducers");
  EXPECT_ERROR(setup::scatter(setup::ScatterTask()), Exit::usage, "--mesh is missing");
}

}  // namespace
}  // namespace palpa::test
