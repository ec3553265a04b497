// How loud the array will be at a participant's ears, before anybody sits in front of it: as predicted, or as measured.
//
// The prediction is the loudest ultrasound within 10 cm of an ear that any of many drives causes: of one focus and of
// several at once, all over the space in which the objects of the plan are felt, in free air. Silent places (nulls) do
// not count. Reflections from hands and tables may add or take away 10 dB.
#pragma once

#include <array>
#include <optional>
#include <span>
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
  std::array<double, 2> db{};   ///< left, right: the loudest that is predicted at the plan's ceiling
  std::vector<Vec3> foci{};     ///< of the drive that causes the louder of them, metres, world
  std::string layout{};         ///< of the plan's loudest method
  bool full_amplitude = false;  ///< its drives are tried with all transducers at the ceiling
  double bound_db = 0;          ///< no drive is louder: all transducers at the ceiling, and in phase at the ear
  /// If the level is above the plan's limit: a lower ceiling at which it is not, 0 if there is no such ceiling.
  double fitting_ceiling = 0;
  std::optional<double> measured{};  ///< dB: the plan's reading, at the plan's ceiling
  double sounding_s = 0;             ///< how long the array may sound in a participant's sitting

  double predicted_db() const;
  /// What counts at the louder ear: as measured, otherwise as predicted.
  double loudest_db() const { return measured.value_or(predicted_db()); }
  const char* word() const { return measured ? "measured" : "predicted"; }
  /// The same of a whole sitting at the loudest level.
  double equivalent_db() const { return study::equivalent_db(loudest_db(), sounding_s); }
};

/// What reflections may add or take away.
inline constexpr double reflections_db = 10;
inline constexpr double ear_ball_m = 0.1;
/// What other drives than those that are tried may add, with equal amplitudes and otherwise: of 1000 random ones on
/// `openmpd` and in `paper`, none was louder by more. It is in the prediction.
inline constexpr double untried_equal_db = 1.5, untried_db = 0.2;
/// A reading that is farther below the prediction than reflections explain is doubted. One so far below is not of this
/// sound.
inline constexpr double impossible_reading_db = 20;

/// `objects` are the boxes around the models of the plan's shapes, in their order; metres, world.
///
/// Computes on the processor: a second for the paper's array. Without `placed`, an array as posed in the world that all
/// methods use, arrays have the pose that they have without a rig. Throws as array::load_layout does.
///
/// The drives are those of gs_pat, or of the solver that a method names, with all amplitudes at the ceiling. They are
/// unequal, and 3 to 5 dB quieter, only with amplitudes by distance (those of `paper`, or named by the method) and the
/// constraint `normalise`, if no model asks for a pressure and boards have amplitudes. Boards play the amplitudes that
/// they have (array/layouts/board_play.hpp). A reading at another ceiling counts with the difference of the two
/// predictions. `full_db`: if it is given, gets what counts at the louder ear at a ceiling of 1.
EarLevel predict_ear_level(const StudyPlan& plan, std::span<const Box> objects, const array::Layout* placed = nullptr,
                           double* full_db = nullptr);

/// Throws bad_usage if the boards of a method's layout would be silent at the plan's ceiling, at the ceiling of its
/// reading, for a model of lower intensity, or for a pressure that a model requests. `placed` as above; the factors of
/// its transducers count.
void refuse_silent(const StudyPlan& plan, const array::Layout* placed = nullptr);

/// A line about a reading that is below the prediction by more than reflections_db; empty otherwise.
std::string doubt_of_reading(const StudyPlan& plan, const EarLevel& level);

/// Published limits for airborne ultrasound at 40 kHz, for comparison (docs/study.md).
struct EarLimit {
  const char* who;
  const char* what;
  double db;
};
const std::vector<EarLimit>& ear_limits();

/// Why nobody may be exposed to it without somebody's approval: it is above the plan's limit, or the reading that says
/// that it is not is impossible. Empty if neither.
std::string needs_approval(const StudyPlan& plan, const EarLevel& level);

/// Throws bad_usage if somebody has signed a level that needs no approval. Warns of a doubtful reading.
void check_signature(const StudyPlan& plan, const EarLevel& level, const std::string& signature);

/// Throws bad_usage if it needs an approval, unless somebody has signed it: `signature` is a text such as the number of
/// an ethics decision.
void refuse_loud(const StudyPlan& plan, const EarLevel& level, const std::string& signature);

}  // namespace palpa::study
