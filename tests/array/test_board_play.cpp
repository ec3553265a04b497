// What boards play of a drive's amplitudes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "array/layouts/board_play.hpp"
#include "array/layouts/builtin_layouts.hpp"
#include "support/boards.hpp"

namespace palpa::array {
namespace {

constexpr double pi = std::numbers::pi;

Drive played(const Layout& layout, Drive drive, double ceiling) {
  BoardPlay(layout).round(drive, ceiling);
  return drive;
}

float largest(const Drive& drive) {
  return std::ranges::max_element(drive, {}, &TransducerDrive::amplitude)->amplitude;
}

/// The amplitudes of a board, by the formula for its pulses.
std::vector<double> steps_of(const std::string& type) {
  std::vector<double> steps;
  if (type == "openmpd") {
    for (int width = 0; width <= 64; ++width)
      steps.push_back(std::sin(width * pi / 128));
  } else {
    for (int intensity = 0; intensity <= 255; ++intensity)
      steps.push_back(std::sin(std::round(std::asin(intensity / 255.0) * 512 / pi) * pi / 512));
  }
  return steps;
}

class BoardsWithSteps : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, BoardsWithSteps, testing::Values("openmpd", "autd3"));

TEST_P(BoardsWithSteps, EachTransducerPlaysTheNearestStepThatIsNotAboveTheCeiling) {
  const Layout layout = load_layout(GetParam());
  const std::vector<double> steps = steps_of(GetParam());
  std::mt19937_64 random(1);
  for (const double ceiling : {1.0, 0.5, 0.3, 0.12, 0.04, 0.02, 0.001}) {
    std::uniform_real_distribution<float> amplitude(0, static_cast<float>(ceiling));
    Drive drive(layout.transducers.size(), {0, 1});
    for (TransducerDrive& one : drive)
      one.amplitude = amplitude(random);
    drive[0].amplitude = static_cast<float>(ceiling);
    const Drive out = played(layout, drive, ceiling);
    for (std::size_t t = 0; t < drive.size(); ++t) {
      const double asked = drive[t].amplitude, most = ceiling * (1 + 1e-6);
      double best = 0;
      for (const double step : steps) {
        if (step <= most && std::abs(step - asked) < std::abs(best - asked)) best = step;
      }
      ASSERT_NEAR(out[t].amplitude, best, 1e-6) << ceiling << " " << t << " " << asked;
      ASSERT_EQ(out[t].phase, 1);
    }
  }
}

TEST_P(BoardsWithSteps, AStepStaysThatStepAndIsHeardFromTheLeastOneOn) {
  const Layout layout = load_layout(GetParam());
  const BoardPlay boards(layout);
  for (const double step : steps_of(GetParam())) {
    Drive drive(layout.transducers.size(), {static_cast<float>(step), 0});
    EXPECT_NEAR(played(layout, drive, 1)[5].amplitude, step, 1e-6);
    EXPECT_EQ(boards.sounds_at(step), step > 0);
  }
  EXPECT_NEAR(boards.least(), GetParam() == "openmpd" ? 0.024541 : 0.0061359, 1e-6);
  EXPECT_FALSE(boards.sounds_at(boards.least() * 0.999));
  EXPECT_EQ(boards.finest()->name, GetParam());
}

TEST(BoardPlay, APartOfTheTransducersOfABoardThatIsOnlyOnOrOffSounds) {
  const Layout layout = load_layout(test::on_off_board());
  for (const double ceiling : {1.0, 0.9, 0.5, 0.25, 0.1, 1.0 / 256, 0.003, 0.0}) {
    Drive drive(layout.transducers.size(), {static_cast<float>(ceiling), 0.0f});
    drive[7].amplitude *= 0.7f;  // on as the others
    const Drive out = played(layout, drive, ceiling);
    int quarters[4]{}, all = 0;
    for (std::size_t t = 0; t < out.size(); ++t) {
      ASSERT_TRUE(out[t].amplitude == 0 || out[t].amplitude == 1);
      if (out[t].amplitude == 0) continue;
      ++all;
      ++quarters[t / 128 * 2 + t % 16 / 8];
    }
    EXPECT_EQ(all, static_cast<int>(std::floor(256 * ceiling + 1e-6)));
    for (const int quarter : quarters)
      EXPECT_NEAR(quarter, 64 * ceiling, 4) << ceiling;
  }
  Drive silent(layout.transducers.size(), {1, 0});
  silent[3].amplitude = 0;
  EXPECT_EQ(played(layout, silent, 1)[3].amplitude, 0);
  EXPECT_DOUBLE_EQ(BoardPlay(layout).least(), 1.0 / 256);
}

TEST(BoardPlay, BoardsOfALayoutPlayTheirOwnStepsAndLoneTransducersWhatTheyAreAsked) {
  Layout layout;
  layout.transducers.push_back({Vec3(1), Vec3(0, 0, 1)});
  ASSERT_TRUE(add_board(layout, "openmpd", Transform(1.0)));
  ASSERT_TRUE(add_board(layout, "autd3", Transform(1.0)));
  const float asked = 0.3f;
  const Drive out = played(layout, Drive(layout.transducers.size(), {asked, 0}), 1);
  EXPECT_EQ(out[0].amplitude, asked);
  EXPECT_NEAR(out[1].amplitude, std::sin(12 * pi / 128), 1e-6);
  EXPECT_NEAR(out.back().amplitude, std::sin(49 * pi / 512), 1e-6) << "one step more is 0.302";
  // At 0.01, only the second board sounds.
  const Drive faint = played(layout, Drive(layout.transducers.size(), {0.01f, 0}), 1);
  EXPECT_EQ(faint[1].amplitude, 0);
  EXPECT_GT(faint.back().amplitude, 0);
  EXPECT_EQ(BoardPlay(layout).finest()->name, "autd3");
}

TEST(BoardPlay, ADriveIsNeverLouderThanItsLoudestTransducerAsksFor) {
  const Layout layout = load_layout("openmpd");
  Drive drive(layout.transducers.size(), {0.505f, 0});
  EXPECT_NEAR(largest(played(layout, drive, 1)), std::sin(21 * pi / 128), 1e-6) << "the next step is nearer, but above";
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -1.0f}) {
    drive[9].amplitude = bad;
    EXPECT_EQ(played(layout, drive, 1)[9].amplitude, 0);
  }
  drive[9].amplitude = 7;
  EXPECT_EQ(played(layout, drive, 1)[9].amplitude, 1);
}

TEST(BoardPlay, FactorsOfABoardsFileMultiplyWhatTheWireCarries) {
  Layout layout = load_layout("openmpd");
  layout.factors.assign(layout.transducers.size(), 0.5f);
  layout.factors[7] = 0;
  layout.factors[8] = 0.25f;
  const BoardPlay boards(layout);
  EXPECT_NEAR(boards.least(), 2 * std::sin(pi / 128), 1e-6);
  EXPECT_FALSE(boards.sounds_at(0.04));
  EXPECT_TRUE(boards.sounds_at(boards.least_to_say()));
  const auto at = [&](float amplitude) { return played(layout, Drive(256, {amplitude, 0}), amplitude); };
  EXPECT_EQ(largest(at(0.04f)), 0);
  const Drive out = at(0.2f);
  EXPECT_NEAR(out[0].amplitude, std::sin(4 * pi / 128), 1e-6);
  EXPECT_EQ(out[7].amplitude, 0);
  EXPECT_NEAR(out[8].amplitude, std::sin(2 * pi / 128), 1e-6);
  layout.factors.assign(256, 0.0f);
  EXPECT_FALSE(BoardPlay(layout).sounds_at(1));
}

TEST(BoardTypes, EachHasARecordThatFitsItsLayout) {
  for (const BoardType& type : board_types()) {
    const Layout layout = load_layout(std::string(type.name));
    ASSERT_EQ(layout.boards.size(), 1u);
    double nearest = 1;
    for (std::size_t t = 1; t < layout.transducers.size(); ++t) {
      const Vec3 way = layout.transducers[t].position - layout.transducers[0].position;
      nearest = std::min(nearest, std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}));
    }
    EXPECT_NEAR(nearest, type.pitch_m, 1e-12) << type.name;
    EXPECT_GE(type.phase_steps, 2u);
    EXPECT_TRUE(type.has_amplitudes() || type.turn != nullptr);
    EXPECT_EQ(find_board_type(type.name), &type);
  }
  EXPECT_EQ(find_board_type("unknown"), nullptr);
}

}  // namespace
}  // namespace palpa::array
