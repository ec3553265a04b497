// Exactly at the limits of places, files and warnings: the last value passes, and the next one does not.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "array/plausible.hpp"
#include "geometry/plausible.hpp"
#include "sensation/pattern.hpp"
#include "setup/files/drive_file.hpp"
#include "setup/files/pattern_file.hpp"
#include "setup/options/nulls.hpp"
#include "setup/options/places.hpp"
#include "setup/options/warnings.hpp"
#include "setup/sessions/play.hpp"
#include "setup/tasks/foci.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::setup {
namespace {

double after(double value) {
  return std::nextafter(value, std::numeric_limits<double>::infinity());
}

/// What is tried with a value; an error or a warning is a refusal.
bool refused(const std::function<void()>& work) {
  std::string error;
  const std::string said = test::stderr_of([&] { error = test::thrown_by(work).what(); });
  return !said.empty() || !error.empty();
}

std::string curve(int points) {
  return fmt::format("[[curve]]\ncorners_m = [0,0,0.1, 0.02,0,0.1]\npoints = {}\n", points);
}

std::string corners(int count) {
  std::string text;
  for (int n = 0; n < count; ++n)
    text += fmt::format("{}{},0,0.1", n == 0 ? "" : ", ", 1e-5 * n);
  return "[[curve]]\npoints = 2\ncorners_m = [" + text + "]\n";
}

std::string points_at(const std::string& a, const std::string& b, const std::string& amplitude = "1") {
  return fmt::format("[[point]]\nposition_m = [{}, 0, 0]\n[[point]]\nposition_m = [{}, 0, 0]\namplitude = {}\n", a, b,
                     amplitude);
}

TEST(AtLimits, PatternsAreReadUpToTheirLimits) {
  const auto is_refused = [](const std::string& text) { return refused([&] { parse_pattern(text, "p.toml"); }); };
  const std::string silent = "[[point]]\nposition_m = [1, 1, 1]\n" + curve(64) + "amplitude = 0\n";
  const std::string point = "[[point]]\nposition_m = [0, 0, 0]\n";
  for (const auto& [taken, refused] : {
           std::pair(curve(64), curve(65)),
           {silent, silent + "[[point]]\nposition_m = [2, 1, 1]\namplitude = 0\n"},
           {corners(4096), corners(4097)},
           {points_at("-100", "100"), points_at("0", "100.0000001")},
           {points_at("0", "1e-6"), points_at("0", "0.999999e-6")},
           {points_at("0", "1", "1e-4"), points_at("0", "1", "0.9999999e-4")},
           {point + "amplitude = 1e6\n", point + "amplitude = 1000000.1\n"},
           {points_at("0", "1", "0") + "radius_m = 0.005\n", points_at("0", "1", "0") + "radius_m = 0.0050001\n"},
           {points_at("0", "1") + "radius_m = 0\n", points_at("0", "1") + "radius_m = 1e-9\n"},
       }) {
    EXPECT_FALSE(is_refused(taken)) << taken.substr(0, 200);
    EXPECT_TRUE(is_refused(refused)) << refused.substr(0, 200);
  }
}

TEST(AtLimits, PlacesOfAFieldAreTakenUpToTheirLimits) {
  const auto is_refused = [](const Vec3& centre, const Vec2& size, std::uint32_t columns, std::uint32_t rows) {
    return refused([&] {
      plane_places({.plane = Plane::xy, .centre = centre, .size_m = size, .columns = columns, .rows = rows});
    });
  };
  constexpr double far_m = 100;
  EXPECT_FALSE(is_refused({far_m, -far_m, far_m}, {far_m, far_m}, 65536, 1));
  EXPECT_TRUE(is_refused({0, 0, 0}, {1, 1}, 65537, 1));
  EXPECT_TRUE(is_refused({0, 0, 0}, {1, 1}, 1, 65537));
  EXPECT_TRUE(is_refused({0, 0, 0}, {after(far_m), 1}, 1, 1));
  EXPECT_TRUE(is_refused({0, 0, 0}, {1, after(far_m)}, 1, 1));
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 centre{0};
    centre[axis] = -after(far_m);
    EXPECT_TRUE(is_refused(centre, {1, 1}, 1, 1)) << axis;
  }
}

TEST(AtLimits, NullsAreTakenUpToTheirLimits) {
  const array::Layout layout = array::load_layout("autd3");
  const auto is_refused = [&](std::size_t count, double radius_m) {
    FocusingOptions options;
    for (std::size_t n = 0; n < count; ++n)
      options.nulls.push_back({{1e-3 * static_cast<double>(n), 0, 0.15}, radius_m});
    array::DriveOptions drive;
    return refused([&] { prepare_nulls(options, layout, drive); });
  };
  EXPECT_FALSE(is_refused(array::most_nulls, array::most_null_radius_m));
  EXPECT_TRUE(is_refused(array::most_nulls + 1, 0));
  EXPECT_TRUE(is_refused(1, after(array::most_null_radius_m)));
  EXPECT_TRUE(is_refused(1, -1e-12));
}

TEST(AtLimits, AnArrayIsWarnedOfBeyondItsLimits) {
  array::Layout layout = array::load_layout("autd3");
  layout.transducers = {{{0, 0, 0}, {0, 0, 1}}};
  layout.boards.clear();
  const auto place = [&](double z) { return array::implausible_place(layout, {{0, 0, z}, {0, 0, z}}); };
  EXPECT_EQ(place(array::most_plausible_distance_m), "");
  EXPECT_NE(place(after(array::most_plausible_distance_m)), "");
  EXPECT_NE(place(0), "") << "beside it is not in front of it";
  EXPECT_EQ(place(1e-9), "");
  for (const double hz : {layout.frequency_hz / 2, layout.frequency_hz * 1.5})
    EXPECT_EQ(array::implausible_frequency(layout, hz), "") << hz;
  EXPECT_NE(array::implausible_frequency(layout, std::nextafter(layout.frequency_hz / 2, 0)), "");
  EXPECT_NE(array::implausible_frequency(layout, after(layout.frequency_hz * 1.5)), "");
  const auto on = [&](double x) { return refused([&] { refuse_place(layout, {x, 0, 0}, "it"); }); };
  EXPECT_TRUE(on(std::nextafter(1e-6, 0)));
  EXPECT_FALSE(on(1e-6));
}

TEST(AtLimits, SizesAndDwellsAreWarnedOfBeyondTheirLimits) {
  const auto size = [](double metres) { return geometry::implausible_size({{0, 0, 0}, {metres, 0, 0}}); };
  EXPECT_EQ(size(5) + size(1e-3), "");
  EXPECT_CONTAINS(size(after(5)), "if they are millimetres, it measures 5 mm");
  EXPECT_CONTAINS(size(std::nextafter(1e-3, 0)), "if they are kilometres");
  EXPECT_EQ(size(5000).find("micrometres"), std::string::npos) << "5 m is a size, in millimetres";
  EXPECT_CONTAINS(size(5001), "if they are micrometres");
  TouchOptions options;
  options.dwell_s = longest_usual_dwell_s;
  EXPECT_FALSE(refused([&] { warn_of_dwell(options); }));
  options.dwell_s = after(longest_usual_dwell_s);
  EXPECT_TRUE(refused([&] { warn_of_dwell(options); }));
}

TEST(AtLimits, SensationsArePlayedUpToTheirFastest) {
  EXPECT_FALSE(refused([] { playable(sensation::most_hz, "it"); }));
  EXPECT_TRUE(refused([] { playable(after(sensation::most_hz), "it"); }));
  // A slot is a whole number of periods, at most a sixteenth of a turn and at most 1.5 ms.
  constexpr double period_s = 25e-6;
  EXPECT_NEAR(usual_slot(0, period_s), longest_own_slot_s, 1e-12);
  for (const double turn_s : {0.5e-3, 2e-3, 10e-3}) {
    const double most_s = turn_s / slots_in_a_turn;
    EXPECT_NEAR(usual_slot(1 / turn_s, period_s), std::max(period_s, std::floor(most_s / period_s + 1e-6) * period_s),
                1e-12);
  }
}

TEST(AtLimits, PhasesOfADriveAreReadUpToAMillionTurns) {
  const array::Layout layout = array::load_layout("autd3");
  const std::filesystem::path file = test::scratch_folder("drive-at-limits") / "d.csv";
  array::Drive drive(layout.transducers.size());
  const auto is_refused = [&](const std::string& phase) {
    std::string text = drive_csv(layout, drive);
    text.replace(text.rfind(',') + 1, std::string::npos, phase + "\n");
    test::write_text(file, text);
    return refused([&] { load_drive(file, layout); });
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_FALSE(is_refused(fmt::format("{}", sign * most_phase_rad)));
    EXPECT_TRUE(is_refused(fmt::format("{}", sign * after(most_phase_rad))));
  }
}

}  // namespace
}  // namespace palpa::setup
