// `palpa drive`, called from C++, from files and from values.
#include "setup/tasks/drive.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "array/layouts/layout.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using setup::AskedFocus;
using setup::DriveTask;
using setup::FocusingOptions;

const std::vector<AskedFocus> two_foci{{{0, 0, 0}, 1}, {{0.02, 0, 0}, 0.5F}};

/// A ball of 6 mm above the openmpd board, as a file.
std::string ball_file() {
  const geometry::Mesh mesh =
      transformed(geometry::icosphere(3e-3, 3), [](const Vec3& p) { return p + Vec3(0, 0, 0.1); });
  const std::filesystem::path file = scratch_folder("drive-task") / "ball.ply";
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file;
}

TEST(DriveTask, APressureIsThatOfEachFocus) {
  FocusingOptions drive;
  drive.pressure_pa = 2000;
  drive.medium.celsius = 25;
  const setup::DriveResult result = setup::make_drive(array::load_layout("paper"), two_foci, drive);
  EXPECT_TRUE(result.pressure_asked);
  EXPECT_FALSE(result.beyond_linear());
  EXPECT_NEAR(result.pressure.pascals[1], 1000, 1);
}

TEST(DriveTask, AFingerIsKeptForSeveralDrives) {
  const std::string file = ball_file();
  DriveTask task;
  task.layout = "openmpd";
  task.foci = {"0,0,96mm", "0,1mm,101mm"};
  task.mesh = file;
  task.drive.transfer = setup::TransferChoice::finger;
  bool read = false;
  const setup::DriveResult result = setup::make_drive(task, {}, [&] { read = true; });
  EXPECT_TRUE(read);
  EXPECT_EQ(result.aimed.size(), 2u);
  EXPECT_EQ(result.over_free_field.size(), 2u);
  const array::Layout openmpd = array::load_layout("openmpd");
  const FocusingOptions usual;
  const auto finger = setup::finger_in_sound("the ball", geometry::load_triangles(file), openmpd, usual);
  setup::make_drive(openmpd, std::vector<AskedFocus>{{{0, 0, 0.12}}}, usual, *finger);
  EXPECT_EQ(setup::to_json(
                make_drive(openmpd, std::vector<AskedFocus>{{{0, 0, 0.096}}, {{0, 0.001, 0.101}}}, usual, *finger)),
            setup::to_json(result));
}

TEST(DriveTask, RefusesFociAndOptionsOutOfRange) {
  constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const array::Layout openmpd = array::load_layout("openmpd");
  const auto drive = [&](const AskedFocus& focus, const FocusingOptions& options = {}) {
    return error_of(
        [&] {
          (void)setup::make_drive(openmpd, std::vector<AskedFocus>{{{0, 0, 0.1}}, focus}, options);
        },
        Exit::usage);
  };
  EXPECT_CONTAINS(drive({{0, 0, 0.1}, 0}), "focus 2: a gain of 0 is not above 0 and at most 1");
  EXPECT_CONTAINS(drive({{0, 0, 0.1}, 1.5F}), "focus 2: a gain of 1.5");
  EXPECT_CONTAINS(drive({{0, 0, 1000}}), "focus 2 is farther than 100 m from the array");
  EXPECT_CONTAINS(drive({openmpd.transducers[7].position}), "focus 2 is where transducer 7 stands");
  FocusingOptions finger;
  finger.transfer = setup::TransferChoice::finger;
  EXPECT_CONTAINS(drive({{0, 0, 0.1}}, finger), "this command has no finger's mesh");
  FocusingOptions silent, still;
  silent.pressure_pa = -1;
  still.medium.frequency = 0;
  EXPECT_CONTAINS(drive({{0, 0, 0.1}}, silent), "a pressure of -1 Pa at each focus is not above 0");
  EXPECT_CONTAINS(drive({{0, 0, 0.1}}, still), "a frequency of 0 Hz is out of range");
  EXPECT_ERROR(setup::make_drive(openmpd, {}, {}), Exit::usage, "no focus is given");
  const geometry::Mesh open{{{0, 0, 0.1}, {1e-3, 0, 0.1}, {0, 1e-3, 0.1}}, {{0, 1, 2}}};
  EXPECT_REFUSED(setup::finger_in_sound("the sheet", open, openmpd, {}), "the sheet: ");
  DriveTask task;
  EXPECT_ERROR(setup::make_drive(task, {}), Exit::usage, "--layout is missing");
  task.layout = "openmpd";
  task.foci = {"0,0,0.1"};
  for (const double pressure : {-5.0, 0.0, 1e12, inf, nan}) {
    task.drive.pressure_pa = pressure;
    EXPECT_ERROR(setup::make_drive(task, {}), Exit::usage, "Pa at each focus is not above 0");
  }
  task.drive.pressure_pa.reset();
  for (const double frequency : {0.0, -4e4, inf, nan}) {
    task.drive.medium.frequency = frequency;
    EXPECT_ERROR(setup::make_drive(task, {}), Exit::usage, "a frequency of ");
  }
  EXPECT_ERROR(setup::make_drive(array::Layout{}, std::vector<AskedFocus>{{{0, 0, 0.1}}}, {}), Exit::usage,
               "has no transducers");
  // Its sound refers to its body and to the layout, which must both stay where they are.
  static_assert(!std::is_move_constructible_v<setup::BodyInSound>);
  static_assert(!std::is_constructible_v<setup::BodyInSound, geometry::Mesh, array::Layout, FocusingOptions>);
}

}  // namespace
}  // namespace palpa::test
