// `palpa field`, called from C++, from files and from values.
#include "setup/tasks/field.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "array/layouts/layout.hpp"
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
  array::Drive rounded = drive;
  rounded[9].amplitude = 1.0000004F;
  EXPECT_NO_THROW((void)setup::sum_field(layout, rounded, setup::plane_places(grid), usual_air()));
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
