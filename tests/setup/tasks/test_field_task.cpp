// The results of `palpa field`, called from C++: the same bytes as the command's, from files and from values.
#include "setup/tasks/field.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "command_json.hpp"
#include "setup/drive_file.hpp"
#include "setup/tasks/drive.hpp"
#include "support/device.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using setup::FieldTask;
using setup::Places;

const setup::Grid grid{
    .plane = setup::Plane::xz, .centre = {0, 0, 0.12}, .size_m = {0.06, 0.08}, .columns = 15, .rows = 20};

acoustics::Air usual_air() {
  return setup::air({}, {});
}

FieldTask task_of(const std::string& layout) {
  FieldTask task;
  task.layout = layout;
  return task;
}

array::Drive drive_to(const array::Layout& layout, const Vec3& focus) {
  return setup::make_drive(layout, std::vector<setup::AskedFocus>{{focus}}, {}).drive;
}

TEST(FieldTask, OfAFocusIsTheCommands) {
  const array::Layout layout = array::load_layout("openmpd");
  const array::Drive drive = drive_to(layout, {0, 0, 0.15});
  const std::vector<std::string> line{"field",    "--layout",  "openmpd", "--focus",   "0,0,150mm", "--plane", "xz",
                                      "--centre", "0,0,120mm", "--size",  "60mm,80mm", "--pixels",  "15,20"};
  FieldTask task = task_of("openmpd");
  task.foci = {"0,0,150mm"};
  task.place.plane = setup::Plane::xz;
  task.place.centre = "0,0,120mm";
  task.place.size = "60mm,80mm";
  task.place.pixels = "15,20";
  for (const setup::Backend backend : {setup::Backend::cpu, setup::Backend::gpu}) {
    const bool host = backend == setup::Backend::cpu;
    setup::CommonOptions common;
    common.backend = backend;
    bool read = false;
    const setup::FieldResult of_files = setup::sum_field(task, common, [&] { read = true; });
    EXPECT_TRUE(read);
    EXPECT_EQ(of_files.foci.size(), 1u);
    const setup::FieldResult of_values = setup::sum_field(layout, drive, setup::plane_places(grid), usual_air(),
                                                          array::Directivity::t4010a1, host ? nullptr : &test_device());
    EXPECT_EQ(of_values.pressures, of_files.pressures);
    EXPECT_EQ(of_values.pressures.size(), 300u);
    const std::string json = command_json(with(line, {"--backend", host ? "cpu" : "gpu"}));
    EXPECT_EQ(untimed(setup::to_json(of_files)), json);
    EXPECT_EQ(untimed(setup::to_json(of_values)), json);
  }
}

TEST(FieldTask, OfADriveOnALineAndAtPointsIsTheCommands) {
  const array::Layout layout = array::load_layout("autd3");
  const array::Drive drive = drive_to(layout, {0, 0, 0.2});
  const std::filesystem::path folder = scratch_folder("field-task");
  const std::string file = folder / "drive.csv", points = folder / "points.ply";
  write_text(file, setup::drive_csv(layout, drive));
  write_text(points,
             "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
             "end_header\n0.01 0.02 0.2\n-0.01 0 0.1\n");
  FieldTask line = task_of("autd3"), of_file = task_of("autd3");
  line.drive_file = of_file.drive_file = file;
  line.place.line = {"0,0,0.1", "0,0,0.3"};
  line.place.samples = 11;
  of_file.place.points = points;
  const struct {
    FieldTask task;
    Places places;
    std::vector<std::string> arguments;
  } cases[]{
      {line, setup::line_places({0, 0, 0.1}, {0, 0, 0.3}, 11), {"--line", "0,0,0.1", "0,0,0.3", "--samples", "11"}},
      {of_file, setup::point_places({{0.01, 0.02, 0.2}, {-0.01, 0, 0.1}}), {"--points", points}}};
  setup::CommonOptions host;
  host.backend = setup::Backend::cpu;
  for (const auto& [task, places, arguments] : cases) {
    const std::string json =
        command_json(with({"field", "--layout", "autd3", "--drive", file, "--backend", "cpu"}, arguments));
    EXPECT_EQ(untimed(setup::to_json(sum_field(task, host))), json);
    EXPECT_EQ(untimed(setup::to_json(sum_field(layout, drive, places, usual_air()))), json);
  }
}

TEST(FieldTask, RefusesDrivesAndPlacesOutOfRange) {
  const array::Layout layout = array::load_layout("openmpd");
  const array::Drive drive(layout.transducers.size()), other(7);
  const auto refused = [](const auto& work, const char* part) { EXPECT_CONTAINS(error_of(work, Exit::usage), part); };
  refused([&] { (void)setup::sum_field(layout, other, setup::plane_places(grid), usual_air()); },
          "the drive belongs to another layout: it has 7 transducers, but openmpd has 256");
  refused([&] { (void)setup::sum_field(layout, drive, {}, usual_air()); }, "there are no points to look at");
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (const float amplitude : {-0.5F, 1.01F, none}) {
    array::Drive odd = drive;
    odd[9].amplitude = amplitude;
    refused([&] { (void)setup::sum_field(layout, odd, setup::plane_places(grid), usual_air()); },
            "of transducer 9 is not within 0..1");
  }
  for (const float phase : {7e6F, none}) {
    array::Drive odd = drive;
    odd[9].phase = phase;
    refused([&] { (void)setup::sum_field(layout, odd, setup::plane_places(grid), usual_air()); },
            "of transducer 9 is more than a million turns");
  }
  refused([&] { (void)setup::sum_field(array::Layout{}, {}, setup::plane_places(grid), usual_air()); },
          "has no transducers");
  setup::Grid bad = grid;
  bad.rows = 0;
  refused([&] { (void)setup::plane_places(bad); }, "the plane's pixels, 15 by 0, are not 1 to 65536");
  bad = grid;
  bad.size_m.y = 0;
  refused([&] { (void)setup::plane_places(bad); }, "the plane's size, 0.06 by 0 m, is not above 0");
  bad = grid;
  bad.centre.x = std::numeric_limits<double>::quiet_NaN();
  refused([&] { (void)setup::plane_places(bad); }, "the plane's centre (nan, 0, 0.12) is not within 100 m");
  refused([] { (void)setup::line_places({0, 0, 0}, {0, 0, 0}, 5); }, "both ends of the line are the same point");
  refused([] { (void)setup::line_places({0, 0, 0}, {0, 0, 1}, 1); }, "a line needs at least 2 samples");
  refused([] { (void)setup::line_places({0, 0, 0}, {0, 0, 101}, 2); }, "the line's end (0, 0, 101) is not within");
  refused([] { (void)setup::point_places({}); }, "there are no points to look at");
  refused([] { (void)setup::point_places({{0, 0, 0}, {0, 200, 0}}); }, "point 1, (0, 200, 0) is not within 100 m");
  refused(
      [] {
        (void)setup::point_places({{0, 0, 0}}, {{0, 0, 1}});
      },
      "a triangle (0, 0, 1) uses a point that is not among the 1 given");
  refused([] { (void)setup::sum_field(FieldTask(), {}); }, "--layout is missing");
  FieldTask line = task_of("openmpd");
  line.foci = {"0,0,0.1"};
  line.place.line = {"0,0,0", "0,0,1"};
  check(line, true);
  check(line);
  FieldTask points = line;
  points.place = {};
  points.place.points = "points.ply";
  refused([&] { check(points, true); }, "--png draws a plane or a line");
  line.drive.pressure_pa = std::numeric_limits<double>::infinity();
  refused([&] { (void)setup::sum_field(line, {}); }, "Pa at each focus is not above 0");
}

TEST(FieldTask, APlaneHasSquarePixelsUnlessTheyAreGiven) {
  setup::Grid square = grid;
  square.columns = square.rows = 0;
  const Places places = setup::plane_places(square);
  EXPECT_EQ(places.grid->columns, 192u);
  EXPECT_EQ(places.grid->rows, 256u);
  EXPECT_EQ(places.points.size(), 192u * 256u);
}

}  // namespace
}  // namespace palpa::test
