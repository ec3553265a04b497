// The results of `palpa scatter`, called from C++: the same bytes as the command's, from files and from values.
#include "setup/tasks/scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "command_json.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/drive_file.hpp"
#include "setup/tasks/drive.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using setup::ScatterResult;
using setup::ScatterTask;

class ScatterOf : public testing::Test {
 protected:
  ScatterOf() {
    const geometry::Mesh ball =
        transformed(geometry::icosphere(3e-3, 3), [](const Vec3& p) { return p + Vec3(0, 0, 0.1); });
    geometry::write_ply(file, ball.positions, ball.triangles);
    mesh = geometry::load_triangles(file);
    task.mesh = file;
  }

  /// From files, from values and from the command.
  void expect_the_same(const ScatterResult& of_values, const std::vector<std::string>& arguments) const {
    bool read = false;
    const ScatterResult of_files = setup::scatter(task, [&] { read = true; });
    EXPECT_TRUE(read);
    const std::string json = command_json(with({"scatter", "--mesh", file}, arguments));
    EXPECT_EQ(untimed(setup::to_json(of_files)), json);
    EXPECT_EQ(untimed(setup::to_json(of_values)), json);
    EXPECT_EQ(of_values.totals.size(), of_files.totals.size());
    EXPECT_EQ(of_values.faces.size(), mesh.triangles.size());
  }

  std::filesystem::path folder = scratch_folder("scatter-task");
  std::string file = folder / "ball.ply";
  geometry::Mesh mesh;
  ScatterTask task;
  const acoustics::Air air = acoustics::without_absorption(setup::air({}, {}));
};

TEST_F(ScatterOf, APlaneWaveIsTheCommands) {
  task.plane_wave = "0,0,2";
  expect_the_same(setup::scatter("ball", mesh, setup::PlaneWave{{0, 0, 2}}, air), {"--plane-wave", "0,0,2"});
}

TEST_F(ScatterOf, APointSourceAtPlacesIsTheCommands) {
  const std::string csv = folder / "places.csv";
  task.point_source = "0,0,130mm";
  task.place.line = {"0,0,95mm", "0,0,105mm"};
  task.place.samples = 3;
  const ScatterResult result = setup::scatter("ball", mesh, setup::PointSource{{0, 0, 0.13}}, air,
                                              setup::line_places({0, 0, 0.095}, {0, 0, 0.105}, 3).points);
  expect_the_same(result,
                  {"--point-source", "0,0,130mm", "--line", "0,0,95mm", "0,0,105mm", "--samples", "3", "--csv", csv});
  const auto rows = read_csv(csv);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_TRUE(std::isnan(result.totals[1].real()));  // within the ball
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_EQ(static_cast<float>(rows[i][3]), static_cast<float>(result.totals[i].real()));
    EXPECT_EQ(static_cast<float>(rows[i][4]), static_cast<float>(result.totals[i].imag()));
  }
}

TEST_F(ScatterOf, AnArraysDriveIsTheCommands) {
  const array::Layout layout = array::load_layout("openmpd");
  const array::Drive drive = setup::make_drive(layout, std::vector<setup::AskedFocus>{{{0, 0, 0.096}}}, {}).drive;
  task.layout = "openmpd";
  task.drive_file = folder / "drive.csv";
  write_text(task.drive_file, setup::drive_csv(layout, drive));
  const ScatterResult result = setup::scatter("ball", mesh, setup::ArraySound{layout, drive}, air);
  EXPECT_TRUE(result.from_array);
  EXPECT_GT(result.load.force.z, 0);
  expect_the_same(result, {"--layout", "openmpd", "--drive", task.drive_file});
}

TEST_F(ScatterOf, SoundsAndBodiesOutOfRangeAreRefused) {
  const array::Layout layout = array::load_layout("openmpd");
  const auto refused = [&](const setup::IncidentSound& sound, const acoustics::Air& in, std::vector<Vec3> points,
                           const char* part) {
    EXPECT_ERROR(setup::scatter("ball", mesh, sound, in, points), Exit::usage, part);
  };
  refused(setup::PlaneWave{}, air, {}, "a plane wave needs a direction whose length is not 0");
  refused(setup::PointSource{{0, 0, 1e5}}, air, {}, "the point source is not within");
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
  EXPECT_ERROR(setup::scatter(ScatterTask()), Exit::usage, "--mesh is missing");
}

}  // namespace
}  // namespace palpa::test
