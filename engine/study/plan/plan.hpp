// The plan of a study as values: shapes, methods, counts, what happens in which order, and what the ideal observer
// needs. PLAN.toml is its file (plan_file.hpp, docs/study.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "base/words.hpp"
#include "study/plan/plan_method.hpp"
#include "touch/types.hpp"

namespace palpa::study {

struct PlanShape {
  std::string name;
  std::string model;           ///< file, relative names resolved from the plan's folder
  std::string model_sha256{};  ///< of the file, if it was read (setup::load_plan)
  bool asks_pressure = false;  ///< whether the model may ask for a pressure at foci, if it was read
  /// The least of the model's objects, if it was read: of a spring, where it is stiffest among the depths of the plan.
  double intensity = 1;
  bool is_spring = false;                       ///< the object with that intensity has a stiffness
  std::optional<double> pressure_pa{};          ///< the least that an object of it requests, if it was read
  std::map<std::string, std::string> labels{};  ///< what participants read instead of the name, by language
};

/// [study]
struct PlanCounts {
  std::uint32_t participants = 10, trials_per_shape = 10;
  double touch_s = 10;
  /// Who has fewer answered trials with a method is left out when methods are compared. By default, three quarters of
  /// the planned ones (default_least_trials).
  std::uint32_t least_trials = 30;
};

/// [observer]
struct PlanObserver {
  std::vector<double> depths_m{1e-3, 3e-3, 5e-3, 7.5e-3, 10.5e-3, 14e-3};  ///< ascending
  std::uint32_t placements = 12;
  double lateral_m = 2e-3, yaw_rad = 0.261799387799149;  ///< standard deviations
  double crest_n = 16e-3;  ///< force of the single focus on the cube at 3 mm, at its crest
  std::vector<double> other_crests_n{5e-3, 50e-3};
};

/// [fit]: the one measured number. Only the simulation needs it.
struct PlanFit {
  std::size_t method = 0;  ///< index into the methods
  double accuracy = 0;
  std::uint32_t trials = 0;  ///< 0: the plan has no [fit]
};

/// What a block asks of a participant. The words are those of the plan and of `trial_type` in logs.
enum class BlockKind {
  familiarise,  ///< touch each shape, and see it
  free,         ///< touch without seeing; keys change the shape
  practice,     ///< as trial, but it is not analysed
  trial,        ///< touch, then say which shape it was
  rest,         ///< a break
};
inline constexpr Word<BlockKind> block_words[] = {{"familiarise", BlockKind::familiarise},
                                                  {"free", BlockKind::free},
                                                  {"practice", BlockKind::practice},
                                                  {"trial", BlockKind::trial},
                                                  {"rest", BlockKind::rest}};
/// Whether it ends with the question which shape it was.
bool asks(BlockKind kind);

/// [[block]]
struct PlanBlock {
  BlockKind kind = BlockKind::trial;
  std::vector<std::uint32_t> shapes{};  ///< indices into the shapes; those of practice are touched in this order
  std::uint32_t repeats = 1;            ///< of each shape
  double touch_s = 10;                  ///< how long a touch, the free exploration or the break lasts
  bool feedback = false;                ///< says after the answer whether it was right
  bool apart = false;                   ///< no shape twice in a row
  bool once = false;                    ///< only before the participant's first method
  std::string text{};                   ///< the instruction, instead of the plan's text for this kind
};

/// Which method a participant begins with.
enum class OrderRule {
  halves,     ///< the first half of the participants as in the plan, the second half in reverse, further ones in turn
  alternate,  ///< odd numbers as in the plan, even numbers in reverse
  williams,   ///< the rows of a Williams square in turn: every method follows every other equally often
  fixed,      ///< as in the plan
};
inline constexpr Word<OrderRule> order_words[] = {{"halves", OrderRule::halves},
                                                  {"alternate", OrderRule::alternate},
                                                  {"williams", OrderRule::williams},
                                                  {"fixed", OrderRule::fixed}};

/// [run]
struct PlanRun {
  OrderRule order = OrderRule::fixed;
  std::uint64_t seed = 1;         ///< of the order of trials
  double deep_m = 15e-3;          ///< nothing is presented while a captured point is deeper than this below the top
  std::string masking = "white";  ///< `white`, `off`, or a sound file
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
  std::optional<touch::Hysteresis> hysteresis{};  ///< as palpa run chooses it, if it is missing
  bool predict = true;
  bool ask_depth_frames = false;  ///< a separate page asks whether depth images may be kept
};

/// [level]: how loud it may be at the participant's ears.
struct PlanLevel {
  double ceiling = 1;     ///< of every transducer's amplitude, as --ceiling
  double limit_db = 110;  ///< peak sound pressure level, dB re 20 uPa, that an ear may get
  /// What a microphone read at the louder ear, dB re 20 uPa, and the ceiling at which it read it. Replaces the
  /// prediction.
  std::optional<double> measured_db{};
  double measured_ceiling = 1;
  std::array<Vec3, 2> ears{Vec3(-0.08, 0.3, 0.65), Vec3(0.08, 0.3, 0.65)};  ///< left, right; metres, world
};

/// The screens of a sitting whose text a plan may set.
enum class TextId {
  consent,
  depth_consent,
  accept,
  decline,
  go_on,
  wait,
  welcome,
  familiarise,
  free,
  practice,
  trial,
  rest,
  felt,
  not_yet,
  which_shape,
  paused,
  right_answer,
  wrong_answer,
  end,
};
struct DefaultText {
  const char* key;  ///< in [texts.LANGUAGE]
  TextId id;
  const char* english;
  bool optional = false;  ///< a plan in another language may leave it out; see StudyPlan::text()
};
const std::vector<DefaultText>& default_texts();

struct StudyPlan {
  std::string file, title;
  std::string sha256;  ///< of the file's bytes
  std::vector<PlanShape> shapes;
  std::vector<PlanMethod> methods;     ///< those of the study
  std::vector<PlanMethod> candidates;  ///< [[candidate]]: only ranked by the simulation
  PlanCounts counts;
  std::vector<PlanBlock> blocks;  ///< the paper's, if the file has none
  PlanRun run;
  PlanLevel level;
  std::string language = "en";
  std::map<std::string, std::map<TextId, std::string>> texts{};  ///< by language
  PlanObserver observer;
  PlanFit fit;

  /// The touches that the simulation computes.
  std::size_t touches() const {
    return (methods.size() + candidates.size()) * shapes.size() * observer.depths_m.size() * observer.placements;
  }
  /// The plan's text in its language, otherwise the built-in English one. In another language, `not_yet` is `wait` if
  /// the plan leaves it out, and `felt` is empty: nothing is asked.
  std::string text(TextId id) const;
  /// What participants read for a shape.
  const std::string& label(std::size_t shape) const;
};

/// A participant's trials with each method.
std::uint32_t trials_of_method(const StudyPlan& plan);
/// Three quarters of them, rounded up.
std::uint32_t default_least_trials(const StudyPlan& plan);

/// What a plan measures less than its author may think, one line each; empty for a usual plan.
std::vector<std::string> doubts_of(const StudyPlan& plan);

/// The most touches of a simulated plan: a few hours of computation.
inline constexpr std::size_t most_planned_touches = 50'000;
/// The most steps of a participant's sitting: days of touching.
inline constexpr std::size_t most_planned_steps = 20'000;

/// The instruction that is shown before a block.
std::string instruction_of(const StudyPlan& plan, const PlanBlock& block);

/// How long the array may sound in a participant's sitting, seconds: all touches and free explorations.
double sounding_s(const StudyPlan& plan);

/// The most time in a sitting that a plan may ask for.
inline constexpr double most_sounding_s = 8 * 3600;

}  // namespace palpa::study
