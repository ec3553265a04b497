// The prediction of fingertips on the shared recordings, relative to the newest place that was seen.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <vector>

#include "hand_motion.hpp"
#include "session/predict/motion_filter.hpp"
#include "support/shared_data.hpp"

namespace palpa::session {
namespace {

using palpa::test::PredictionError;
using palpa::test::TipPath;
using palpa::test::TipPredictor;

TipPredictor filtered(double noise_m) {
  const auto filter = std::make_shared<MotionFilter>(noise_m);
  return {[filter](double t, const Vec3& place) { filter->see(t, place); },
          [filter](double ahead) { return filter->at(ahead); }};
}

std::vector<TipPath> thinned(const std::vector<TipPath>& paths, double rate_hz) {
  std::vector<TipPath> out;
  for (const TipPath& path : paths) {
    const double own = static_cast<double>(path.time_s.size() - 1) / (path.end_s() - path.begin_s());
    out.push_back(path.thinned(static_cast<std::size_t>(std::lround(own / rate_hz))));
  }
  return out;
}

TEST(MotionFilter, AboutHalvesTheErrorOfRecordedFingersThatMoveAndDoesNotHarmAtRest) {
  PALPA_SHARED_OR_SKIP(data, "hand-motion");
  const auto markers = test::marker_tips(), slow = thinned(markers, 30), leap = test::leap_tips();
  ASSERT_EQ(markers.size(), 16U);
  ASSERT_GT(leap.size(), 30U);
  /// The sensor's noise is known only roughly. Errors are relative to those of the newest place that was seen.
  struct Case {
    const char* name;
    const std::vector<TipPath>& tips;
    std::vector<double> noises_m, assumed_m;  ///< assumed: empty if the noise is known
    std::vector<double> aheads_s;
    std::size_t least_moves;
    double move, move_far;      ///< of fingers that move; up to 30 ms ahead and beyond
    double median, median_far;  ///< the same
    double rest;                ///< of those that rest or turn
  };
  const double any = 10;
  for (const Case& c :
       {Case{"markers", markers, {0.1e-3, 0.2e-3, 0.3e-3}, {}, {20e-3, 30e-3, 50e-3}, 1000, 0.5, 0.6, 0.5, 0.5, 1.1},
        {"markers of a slow camera", slow, {0.3e-3}, {}, {30e-3, 50e-3}, 0, 0.55, 0.65, any, any, 1.1},
        {"a tracker, filtered", leap, {0}, {0.1e-3}, {20e-3, 30e-3, 50e-3}, 5000, 0.55, 0.65, 0.5, 0.55, 1.1},
        {"a wrong noise", markers, {0.1e-3, 0.3e-3}, {0.2e-3, 0.4e-3}, {30e-3}, 0, 0.55, 0.55, any, any, 1.2}}) {
    for (const double noise_m : c.noises_m) {
      for (const double assumed_m : c.assumed_m.empty() ? std::vector{noise_m} : c.assumed_m) {
        for (const double ahead_s : c.aheads_s) {
          const PredictionError error = test::error_of(
              c.tips, [=] { return filtered(assumed_m); }, ahead_s, noise_m);
          SCOPED_TRACE(fmt::format("{}: {} s, {} m, assumed {} m", c.name, ahead_s, noise_m, assumed_m));
          EXPECT_GT(error.moves, c.least_moves);
          if (&c.tips == &markers) {
            EXPECT_GT(error.rests, 1000U);
            EXPECT_GT(error.turns, 5U);
          }
          EXPECT_LE(error.move, ahead_s <= 30e-3 ? c.move : c.move_far);
          EXPECT_LE(error.median, ahead_s <= 30e-3 ? c.median : c.median_far);
          EXPECT_LE(error.rest, c.rest);
          EXPECT_LE(error.turn, c.rest);
        }
      }
    }
  }
}

/// A point that moves at a constant speed, as a camera of this rate sees it.
void see_motion(MotionFilter& filter, const Vec3& velocity, double from_s, double to_s, double rate_hz, double noise_m,
                std::uint32_t seed, bool tracked = false) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (double t = from_s; t < to_s; t += 1 / rate_hz)
    filter.see(t, velocity * t + noise_m * Vec3(normal(random), normal(random), normal(random)), tracked);
}

TEST(MotionFilter, FollowsASteadyMotionAndPredictsNothingAtRest) {
  for (const double rate : {30.0, 90.0}) {
    for (const double noise : {0.1e-3, 0.3e-3}) {
      double sum = 0;
      for (std::uint32_t seed = 0; seed < 20; ++seed) {
        MotionFilter moving(noise), still(noise);
        see_motion(moving, {0.2, 0, 0}, 0, 0.5, rate, noise, seed);
        sum += moving.velocity().x / 20;
        see_motion(still, Vec3(0), 0, 0.5, rate, noise, seed);
        EXPECT_LT(glm::length(still.velocity()) * 60e-3, 1.5 * noise) << "hardly more than the noise";
      }
      EXPECT_LT(sum, 0.95 * 0.2) << "the factor of the prediction";
      EXPECT_GT(sum, (rate > 50 ? 0.6 : 0.35) * 0.2) << "at a low rate, less is certain";
    }
  }
}

TEST(MotionFilter, DoesNotShortenATrackersSlowMotion) {
  for (const double rate : {60.0, 90.0}) {
    for (const double speed : {0.05, 0.1, 0.2}) {
      double sum = 0;
      for (std::uint32_t seed = 0; seed < 20; ++seed) {
        MotionFilter filter(0.1e-3);
        see_motion(filter, {speed, 0, 0}, 0, 0.6, rate, 0.1e-3, seed, true);
        sum += filter.velocity().x / 20;
      }
      EXPECT_NEAR(sum, speed, 0.05 * speed) << rate << " Hz, " << speed << " m/s";
    }
  }
}

TEST(MotionFilter, KnowsNoSpeedAtFirst) {
  MotionFilter filter;
  EXPECT_EQ(filter.velocity(), Vec3(0));
  filter.see(1, {0.1, 0.2, 0.3});
  EXPECT_EQ(filter.velocity(), Vec3(0));
  EXPECT_EQ(filter.at(0.06), Vec3(0.1, 0.2, 0.3));
  filter.see(1.011, {0.1004, 0.2, 0.3});
  EXPECT_LT(glm::length(filter.velocity()), 0.01) << "one step of a millimetre may be noise";
}

TEST(MotionFilter, RestartsWhenTheClockJumpsAndStandsWhenItStands) {
  MotionFilter filter;
  for (const double jump_s : {-1e-3, -3600.0, 3600.0, 0.2}) {
    filter.restart();
    see_motion(filter, {0, 0.3, 0}, 0, 0.3, 90, 0, 1);
    EXPECT_GT(filter.velocity().y, 0.2);
    const double last_s = 26.0 / 90;
    filter.see(last_s + jump_s, {0, 0.09, 0});
    EXPECT_EQ(filter.velocity(), Vec3(0)) << jump_s;
    EXPECT_EQ(filter.place(), Vec3(0, 0.09, 0));
  }
  filter.restart();
  for (int k = 0; k < 50; ++k) {  // a clock that stands still says nothing about speed
    filter.see(5, {0.004 * k, 0, 0});
    EXPECT_EQ(filter.velocity(), Vec3(0));
  }
}

TEST(MotionFilter, IsNeverFasterThanAHand) {
  MotionFilter filter;
  see_motion(filter, {60, 0, 0}, 0, 0.3, 90, 0, 1);
  EXPECT_NEAR(glm::length(filter.velocity()), MotionFilter::most_speed, 1e-9);
}

}  // namespace
}  // namespace palpa::session
