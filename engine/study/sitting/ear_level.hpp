// How loud the array will be at a participant's ears, predicted before anybody sits in front of it.
//
// The prediction is the loudest ultrasound that one focus can cause within 10 cm of an ear: over foci all over the
// space in which the objects are felt, and over places in the ball around the ear, in free air. Reflections from hands
// and tables may add or take away 10 dB.
#pragma once

#include <array>
#include <atomic>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "study/plan/plan.hpp"

namespace palpa::study {

/// The level that a sound of 8 hours with the same energy has as one of `level_db` that lasts `sounding_s`:
/// level + 10 log10(sounding / 8 h).
double equivalent_db(double level_db, double sounding_s);

/// Levels are sound pressure levels of the tone: 20 log10(p / sqrt(2) / 20 uPa) for the peak pressure p.
struct EarLevel {
  std::array<double, 2> db{};  ///< left, right: the loudest, at the plan's ceiling
  Vec3 focus{};                ///< that causes the louder of them, metres, world
  std::string layout{};        ///< of the plan's loudest method
  double sounding_s = 0;       ///< how long the array may sound in a participant's sitting

  double loudest_db() const;
  /// The same of a whole sitting at the loudest level.
  double equivalent_db() const { return study::equivalent_db(loudest_db(), sounding_s); }
};

/// What reflections may add or take away.
inline constexpr double reflections_db = 10;
inline constexpr double ear_ball_m = 0.1;

/// Computes on the processor: a second for the paper's array. Without `placed`, an array as posed in the world that all
/// methods use, arrays have the pose that they have without a rig. Throws as array::load_layout does.
EarLevel predict_ear_level(const StudyPlan& plan, const array::Layout* placed = nullptr);

/// Published limits for airborne ultrasound at 40 kHz, for comparison (docs/study.md).
struct EarLimit {
  const char* who;
  const char* what;
  double db;
};
const std::vector<EarLimit>& ear_limits();

/// Throws bad_usage if the level is above the plan's limit, unless somebody has signed that it may be: `signature` is a
/// text such as the number of an ethics decision.
void refuse_loud(const StudyPlan& plan, const EarLevel& level, const std::string& signature);

}  // namespace palpa::study
