// What boards play of drives that request a pressure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/requested_play.hpp"

namespace palpa::array {
namespace {

constexpr double pi = std::numbers::pi;

const DriveOptions options{.directivity = Directivity::omni};

double pressure_at(const Layout& layout, const Drive& drive, const Vec3& place) {
  std::complex<double> sum = 0;
  for (std::size_t t = 0; t < drive.size(); ++t) {
    const double far = glm::length(place - layout.transducers[t].position);
    const double phase = drive[t].phase + 2 * pi * far * options.medium.turns_per_metre();
    sum += std::polar(drive[t].amplitude / far, phase);
  }
  return layout.source_level_pa_m * std::abs(sum);
}

SlotFocus asking(const Vec3& place, double pascals) {
  return {.position = place, .pressure_pa = pascals, .most_pa = pascals};
}

/// The drive of one focus, as loud as requested.
Drive drive_of(const Layout& layout, const SlotFocus& focus) {
  Drive drive = drive_for(layout, {&focus, 1}, options);
  const double full_pa = pressure_at(layout, drive, focus.position);
  for (TransducerDrive& one : drive)
    one.amplitude *= static_cast<float>(focus.pressure_pa.value() / full_pa);
  return drive;
}

Drive played(const Layout& layout, Drive drive, const std::vector<SlotFocus>& foci, double ceiling) {
  const BoardPlay boards(layout);
  RequestedPlay play(layout, boards, options);
  play.round(drive, foci, ceiling, 1);
  return drive;
}

/// The largest pressure up to `most_pa` of all common factors.
double best_of(const Layout& layout, const Drive& drive, const Vec3& place, double ceiling, double most_pa) {
  const BoardPlay boards(layout);
  std::vector<float> amplitudes(drive.size());
  Drive tried = drive;
  double best = 0;
  for (double factor = 0.1; factor < 8; factor *= 1.003) {
    boards.play(drive, static_cast<float>(factor), ceiling, amplitudes);
    for (std::size_t t = 0; t < drive.size(); ++t)
      tried[t].amplitude = amplitudes[t];
    const double pascals = pressure_at(layout, tried, place);
    if (pascals <= most_pa) best = std::max(best, pascals);
  }
  return best;
}

TEST(RequestedPlay, OneFocusHasTheMostThatACommonFactorGivesAndNeverMoreThanRequested) {
  for (const BoardType& type : board_types()) {
    const std::string name(type.name);
    const Layout layout = load_layout(name);
    for (const Vec3 place : {Vec3(0, 0, 0.15), Vec3(0.03, -0.02, 0.12)}) {
      for (const double asked : {60.0, 150.0, 300.0, 500.0, 1000.0, 2500.0}) {
        const SlotFocus focus = asking(place, asked);
        const Drive drive = drive_of(layout, focus), out = played(layout, drive, {focus}, 1);
        const double pascals = pressure_at(layout, out, place);
        EXPECT_LE(pascals, asked * (1 + 1e-5)) << name;
        EXPECT_GE(pascals, 0.998 * best_of(layout, drive, place, 1, asked)) << name << " " << asked;
        if (type.has_amplitudes() && asked >= 150) {
          EXPECT_GT(pascals, 0.96 * asked) << name << " " << asked;
        }
      }
    }
  }
}

TEST(RequestedPlay, NoTransducerIsAboveTheCeilingAndWhatIsOutOfReachTakesAllOfIt) {
  const Layout layout = load_layout("openmpd");
  const SlotFocus focus = asking({0, 0, 0.15}, 400);
  const Drive drive = drive_of(layout, focus);
  const float loudest = std::ranges::max_element(drive, {}, &TransducerDrive::amplitude)->amplitude;
  for (const double ceiling : {0.03, 0.06, 0.5}) {
    const Drive out = played(layout, drive, {focus}, ceiling);
    for (const TransducerDrive& one : out)
      EXPECT_LE(one.amplitude, ceiling);
    EXPECT_LE(pressure_at(layout, out, focus.position), 400 * (1 + 1e-5));
    if (ceiling == 0.03) {
      for (const TransducerDrive& one : out)
        EXPECT_NEAR(one.amplitude, std::sin(pi / 128), 1e-6) << loudest;
    }
  }
}

TEST(RequestedPlay, SeveralFociAreAllKeptBelowTheirRequests) {
  const Layout layout = load_layout("openmpd");
  const std::vector<Vec3> places{{0.02, 0, 0.15}, {-0.02, 0.01, 0.15}, {0, -0.03, 0.15}};
  std::vector<SlotFocus> foci;
  for (const Vec3& place : places)
    foci.push_back(asking(place, 200));
  DriveOptions asked = options;
  Drive drive = drive_for(layout, foci, asked);
  const Drive out = played(layout, drive, foci, 1);
  double least = 1;
  for (const Vec3& place : places) {
    const double exact = pressure_at(layout, drive, place), now = pressure_at(layout, out, place);
    EXPECT_NEAR(exact, 200, 1);
    EXPECT_LE(now, exact * (1 + 1e-5));
    least = std::min(least, now / exact);
  }
  EXPECT_GT(least, 0.8);
}

TEST(RequestedPlay, FactorsOfABoardsFileAreMadeUpFor) {
  Layout layout = load_layout("openmpd");
  layout.factors.assign(layout.transducers.size(), 0.5f);
  const SlotFocus focus = asking({0, 0, 0.15}, 500);
  const Drive drive = drive_of(layout, focus), out = played(layout, drive, {focus}, 1);
  const double pascals = pressure_at(layout, out, focus.position);
  EXPECT_LE(pascals, 500 * (1 + 1e-5));
  EXPECT_GT(pascals, 0.97 * 500);
}

TEST(RequestedPlay, WhatRequestsNothingIsRoundedToTheNearestStep) {
  const Layout layout = load_layout("openmpd");
  const SlotFocus focus{.position = {0, 0, 0.15}};
  Drive drive = drive_for(layout, {&focus, 1}, options), expected = drive;
  BoardPlay(layout).round(expected, 1);
  const Drive out = played(layout, drive, {focus}, 1);
  for (std::size_t t = 0; t < out.size(); ++t)
    ASSERT_EQ(out[t].amplitude, expected[t].amplitude);
}

}  // namespace
}  // namespace palpa::array
