#include "study/sitting/ear_level.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/board_play.hpp"
#include "array/requested_play.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"

namespace palpa::study {
namespace {

constexpr array::Directivity directivity_kind = array::Directivity::t4010a1;

/// Foci that sound at once.
using FocusSet = std::vector<Vec3>;

/// Van der Corput's sequence: 0..1, evenly spread however many are taken.
double spread_out(std::uint32_t number, std::uint32_t base) {
  double value = 0, digit = 1;
  for (; number > 0; number /= base) {
    digit /= base;
    value += digit * (number % base);
  }
  return value;
}

/// The parts of the objects that are felt: from their top down to the depth at which sound stops. What is within
/// another one is left out.
std::vector<Box> felt_spaces(std::span<const Box> objects, double deep_m) {
  const auto holds = [](const Box& box, const Box& other) {
    constexpr double rounding_m = 1e-6;
    const Vec3 low = other.low - box.low, high = box.high - other.high;
    return std::min({low.x, low.y, low.z, high.x, high.y, high.z}) > -rounding_m;
  };
  std::vector<Box> spaces;
  for (Box space : objects) {
    space.low.y = std::max(space.low.y, space.high.y - deep_m);
    if (std::ranges::any_of(spaces, [&](const Box& other) { return holds(other, space); })) continue;
    std::erase_if(spaces, [&](const Box& other) { return holds(space, other); });
    spaces.push_back(space);
  }
  return spaces;
}

/// Sets all over a space, more of them in one that is wider than the paper's objects. More foci at once than ten are no
/// louder.
void add_sets(const Box& space, std::vector<FocusSet>& sets) {
  for (const double y : {space.high.y, space.low.y}) {
    for (const double x : {space.low.x, space.centre().x, space.high.x}) {
      for (const double z : {space.low.z, space.centre().z, space.high.z})
        sets.push_back({Vec3(x, y, z)});
    }
  }
  constexpr double papers_m2 = 0.04 * 0.04, most_times = 8;
  const Vec3 size = space.high - space.low;
  const auto times = static_cast<std::size_t>(std::clamp(size.x * size.z / papers_m2, 1.0, most_times));
  std::uint32_t number = 0;
  const auto add = [&](std::size_t count, std::size_t foci) {
    for (std::size_t i = 0; i < times * count; ++i) {
      FocusSet& set = sets.emplace_back();
      while (set.size() < foci) {
        ++number;
        const Vec3 part(spread_out(number, 2), 1 - spread_out(number, 3), spread_out(number, 5));
        set.push_back(space.low + part * size);
      }
    }
  };
  add(110, 1);
  for (const std::size_t foci : {2u, 4u, 10u})
    add(32, foci);
}

/// Places all over the ball, evenly by volume: the directions of a Fibonacci lattice, in radii that grow as cube roots.
std::vector<Vec3> ball_around(const Vec3& centre) {
  constexpr int count = 500;
  std::vector<Vec3> places{centre};
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count, up = 1 - 2 * std::fmod(i * std::numbers::phi, 1.0);
    const double around = 2 * std::numbers::pi * std::fmod(i * std::numbers::sqrt2, 1.0);
    const double flat = std::sqrt(1 - up * up), radius = ear_ball_m * std::cbrt(t);
    places.push_back(centre + radius * Vec3(flat * std::cos(around), up, flat * std::sin(around)));
  }
  return places;
}

array::Layout in_default_pose(const array::Layout& layout) {
  return array::transformed(layout, layout.default_T_world_layout);
}

double level_of(double pascals) {
  constexpr double reference_pa = 20e-6;
  return 20 * std::log10(std::max(pascals, 1e-12) / std::numbers::sqrt2 / reference_pa);
}

/// The pressure that each drive causes at the place if the sounds of all transducers are in phase there.
std::vector<double> pressures_in_phase(const array::Layout& layout, const std::vector<array::Drive>& drives,
                                       const acoustics::Air& air, std::span<const double> directivity,
                                       const Vec3& place) {
  std::vector<double> sums(drives.size());
  for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
    const auto& [position, axis] = layout.transducers[t];
    const Vec3 way = place - position;
    const double distance = std::max(glm::length(way), layout.transducer_radius_m);
    const double at =
        (std::clamp(glm::dot(way, axis) / distance, -1.0, 1.0) + 1) / 2 * static_cast<double>(array::directivity_steps);
    const auto below = std::min(static_cast<std::size_t>(at), array::directivity_steps - 1);
    const double part = at - static_cast<double>(below);
    const double towards = (1 - part) * directivity[below] + part * directivity[below + 1],
                 left = std::exp(-air.absorption_np_m * distance);
    for (std::size_t d = 0; d < drives.size(); ++d)
      sums[d] += static_cast<double>(drives[d][t].amplitude) * towards * left / distance;
  }
  for (double& sum : sums)
    sum *= layout.source_level_pa_m;
  return sums;
}

/// Multiplies a drive by the ceiling, as a link does, and rounds it to the amplitudes that the boards have.
void play_at(double ceiling, const array::BoardPlay& boards, array::Drive& drive) {
  for (array::TransducerDrive& transducer : drive)
    transducer.amplitude *= static_cast<float>(ceiling);
  boards.round(drive, ceiling);
}

/// The drives of all sets at each ceiling, one ceiling after the other.
acoustics::Strengths strengths_of(const array::Layout& layout, const std::vector<FocusSet>& sets,
                                  const array::DriveOptions& options, std::span<const double> ceilings) {
  std::vector<acoustics::Strengths> at(ceilings.size());
  const array::BoardPlay boards(layout);
  array::DriveScratch scratch;
  array::reserve(scratch, layout, options, 10);
  array::Drive drive(layout.transducers.size()), played;
  for (const FocusSet& set : sets) {
    std::vector<array::SlotFocus> foci(set.size());
    for (std::size_t i = 0; i < set.size(); ++i)
      foci[i].position = set[i];
    array::drive_for(layout, foci, options, drive, scratch);
    for (std::size_t c = 0; c < ceilings.size(); ++c) {
      played = drive;
      play_at(ceilings[c], boards, played);
      const acoustics::Strengths own = acoustics::strengths_of(played);
      at[c].insert(at[c].end(), own.begin(), own.end());
    }
  }
  for (std::size_t c = 1; c < at.size(); ++c)
    at[0].insert(at[0].end(), at[c].begin(), at[c].end());
  return std::move(at[0]);
}

bool has_amplitudes(const array::Board& board) {
  const array::BoardType* const type = array::find_board_type(board.type);
  return type == nullptr || type->has_amplitudes();
}

/// An array, and how a method drives it.
struct Sounding {
  array::Layout layout;
  bool equal = true;  ///< all amplitudes may be equal
  array::Solver solver{};
};

/// The arrays of the plan's methods, each once.
std::vector<array::Layout> layouts_of(const StudyPlan& plan, const array::Layout* placed) {
  std::set<std::string> names;
  for (const PlanMethod& method : plan.methods)
    names.insert(method.layout);
  std::vector<array::Layout> layouts;
  for (const std::string& name : names) {
    layouts.push_back(placed != nullptr ? *placed : in_default_pose(array::load_layout(name)));
    layouts.back().name = name;
  }
  return layouts;
}

/// The same for each way in which methods drive an array.
std::vector<Sounding> soundings_of(const StudyPlan& plan, const array::Layout* placed) {
  const bool asks = std::ranges::any_of(plan.shapes, &PlanShape::asks_pressure);
  std::vector<Sounding> soundings;
  for (const array::Layout& layout : layouts_of(plan, placed)) {
    const bool on_off = !std::ranges::all_of(layout.boards, has_amplitudes);
    for (const PlanMethod& method : plan.methods) {
      if (method.layout != layout.name) continue;
      const bool equal = asks || on_off || method.constraint != array::Constraint::normalise ||
                         method.amplitude.value_or(layout.amplitude_law) == array::Weighting::uniform;
      const array::Solver solver = method.solver.value_or(array::Solver::gs_pat);
      const auto same = [&](const Sounding& one) {
        return one.layout.name == layout.name && one.equal == equal && one.solver == solver;
      };
      if (std::ranges::none_of(soundings, same)) soundings.push_back({layout, equal, solver});
    }
  }
  return soundings;
}

/// The level of a plan's sound at any ceiling. Several at once take little longer than one.
class Prediction {
 public:
  Prediction(const StudyPlan& plan, std::span<const Box> objects, const array::Layout* placed)
      : plan_(plan),
        soundings_(soundings_of(plan, placed)),
        places_(ball_around(plan.level.ears[0])),
        per_ear_(places_.size()) {
    const std::vector<Vec3> right = ball_around(plan.level.ears[1]);
    places_.insert(places_.end(), right.begin(), right.end());
    for (const Box& space : felt_spaces(objects, plan.run.deep_m))
      add_sets(space, sets_);
  }

  std::vector<EarLevel> at(std::span<const double> ceilings) const {
    std::vector<EarLevel> levels(
        ceilings.size(),
        EarLevel{.db = {level_of(0), level_of(0)}, .bound_db = level_of(0), .sounding_s = study::sounding_s(plan_)});
    for (const Sounding& sounding : soundings_)
      add(sounding, ceilings, levels);
    return levels;
  }

  /// A ceiling below `ceiling` whose predicted level is at most `most_db`; 0 if the boards are silent there.
  double fitting(double ceiling, double most_db) const {
    while (!is_silent(ceiling)) {
      const double above_db = at({&ceiling, 1})[0].predicted_db() - most_db;
      if (above_db <= 0) return ceiling;
      ceiling = rounded_down(ceiling * std::pow(10, -std::max(above_db, 0.01) / 20));
    }
    return 0;
  }
  bool is_silent(double ceiling) const {
    return std::ranges::any_of(soundings_,
                               [&](const Sounding& one) { return !array::BoardPlay(one.layout).sounds_at(ceiling); });
  }

 private:
  /// Three decimals, and two digits of what is smaller.
  static double rounded_down(double ceiling) {
    const double step = std::min(1e-3, std::pow(10, std::floor(std::log10(ceiling)) - 1));
    return std::floor(ceiling / step + 1e-9) * step;
  }
  void add(const Sounding& sounding, std::span<const double> ceilings, std::vector<EarLevel>& levels) const;
  void add_tried(const array::Layout& layout, bool equal, std::span<const std::complex<double>> pressures,
                 EarLevel& level) const;

  const StudyPlan& plan_;
  std::vector<Sounding> soundings_;
  std::vector<Vec3> places_;
  std::size_t per_ear_;
  std::vector<FocusSet> sets_;
};

void Prediction::add(const Sounding& sounding, std::span<const double> ceilings, std::vector<EarLevel>& levels) const {
  const auto& [layout, equal, solver] = sounding;
  const acoustics::Air air = acoustics::air_of({}, layout.frequency_hz);
  const array::DriveOptions options{.weighting = equal ? array::Weighting::uniform : array::Weighting::distance,
                                    .constraint = equal ? array::Constraint::uniform : array::Constraint::normalise,
                                    .medium = air.medium,
                                    .solver = solver,
                                    .directivity = directivity_kind};
  const acoustics::Incident incident(layout, air, directivity_kind);
  acoustics::Waves waves;
  incident.at(places_, {}, strengths_of(layout, sets_, options, ceilings), waves);
  const std::size_t tried = sets_.size() * places_.size();
  std::vector<array::Drive> all(ceilings.size(), array::Drive(layout.transducers.size(), {1.0f, 0.0f}));
  for (std::size_t c = 0; c < ceilings.size(); ++c) {
    add_tried(layout, equal, std::span(waves.pressures).subspan(c * tried, tried), levels[c]);
    play_at(ceilings[c], array::BoardPlay(layout), all[c]);
  }
  const std::vector<double> table = array::directivity_table(
      directivity_kind, 2 * std::numbers::pi * air.medium.turns_per_metre() * layout.transducer_radius_m);
  for (const Vec3& place : places_) {
    const std::vector<double> in_phase = pressures_in_phase(layout, all, air, table, place);
    for (std::size_t c = 0; c < ceilings.size(); ++c)
      levels[c].bound_db = std::max(levels[c].bound_db, level_of(in_phase[c]));
  }
}

void Prediction::add_tried(const array::Layout& layout, bool equal, std::span<const std::complex<double>> pressures,
                           EarLevel& level) const {
  std::array<double, 2> loudest{-1, -1};
  for (std::size_t i = 0; i < pressures.size(); ++i) {
    const std::size_t ear = i % places_.size() < per_ear_ ? 0 : 1;
    const double pressure = std::abs(pressures[i]);
    if (pressure <= loudest[ear]) continue;
    loudest[ear] = pressure;
    const double db = level_of(pressure) + (equal ? untried_equal_db : untried_db);
    if (db > level.predicted_db()) {
      level.foci = sets_[i / places_.size()];
      level.layout = layout.name;
      level.full_amplitude = equal;
    }
    level.db[ear] = std::max(level.db[ear], db);
  }
}

}  // namespace

double EarLevel::predicted_db() const {
  return std::max(db[0], db[1]);
}

double equivalent_db(double level_db, double sounding_s) {
  constexpr double day_s = 8 * 3600;
  return level_db + 10 * std::log10(std::max(sounding_s, 1e-9) / day_s);
}

EarLevel predict_ear_level(const StudyPlan& plan, std::span<const Box> objects, const array::Layout* placed,
                           double* full_db) {
  assert(objects.size() == plan.shapes.size());
  const Prediction prediction(plan, objects, placed);
  std::vector<double> ceilings{plan.level.ceiling};
  const auto at_once = [&](double ceiling) {
    if (std::ranges::find(ceilings, ceiling) == ceilings.end()) ceilings.push_back(ceiling);
  };
  const bool has_reading = plan.level.measured_db && !prediction.is_silent(plan.level.measured_ceiling);
  if (has_reading) at_once(plan.level.measured_ceiling);
  if (full_db != nullptr) at_once(1);
  const std::vector<EarLevel> levels = prediction.at(ceilings);
  const auto predicted_db = [&](double ceiling) {
    return levels[static_cast<std::size_t>(std::ranges::find(ceilings, ceiling) - ceilings.begin())].predicted_db();
  };
  const auto measured = [&](double ceiling) -> std::optional<double> {
    if (!has_reading) return std::nullopt;
    return *plan.level.measured_db + predicted_db(ceiling) - predicted_db(plan.level.measured_ceiling);
  };
  EarLevel level = levels[0];
  level.measured = measured(plan.level.ceiling);
  if (full_db != nullptr) *full_db = measured(1).value_or(predicted_db(1));
  if (const double above_db = level.loudest_db() - plan.level.limit_db; above_db > 0)
    level.fitting_ceiling = prediction.fitting(plan.level.ceiling, level.predicted_db() - above_db);
  return level;
}

namespace {

/// Whether a focus in the middle of the objects sounds that requests this pressure, times the gain and the ceiling.
bool request_sounds(const array::Layout& layout, const array::BoardPlay& boards, double ceiling, double gain,
                    double pressure_pa, double& amplitude) {
  array::SlotFocus focus{};
  array::Drive drive = array::drive_for(layout, {&focus, 1}, {.weighting = layout.amplitude_law});
  const double full_pa = std::abs(acoustics::pressure_at(layout, drive, focus.position));
  amplitude = ceiling * std::min(1.0, pressure_pa * gain / full_pa);
  focus.pressure_pa = focus.most_pa = pressure_pa * gain;
  for (array::TransducerDrive& one : drive)
    one.amplitude *= static_cast<float>(amplitude);
  array::RequestedPlay(layout, boards, {}).round(drive, {&focus, 1}, ceiling, ceiling);
  return std::ranges::any_of(drive, [](const array::TransducerDrive& one) { return one.amplitude > 0; });
}

}  // namespace

void refuse_silent(const StudyPlan& plan, const array::Layout* placed) {
  for (const array::Layout& layout : layouts_of(plan, placed)) {
    const array::BoardPlay boards(layout);
    const auto refuse = [&](const std::string& what) {
      throw bad_usage(
          fmt::format("{}: {}, below {:g}, the least amplitude that the {} boards of {} play{}: they would be silent",
                      plan.file, what, boards.least_to_say(), boards.finest()->title, layout.name,
                      boards.has_factors() ? " with the factors of their files" : ""));
    };
    if (!boards.sounds_at(plan.level.ceiling))
      refuse(fmt::format("the ceiling of [level] is {:g}", plan.level.ceiling));
    if (plan.level.measured_db && !boards.sounds_at(plan.level.measured_ceiling))
      refuse(fmt::format("measured_ceiling of [level] is {:g}", plan.level.measured_ceiling));
    if (boards.finest() == nullptr) continue;
    for (const PlanShape& shape : plan.shapes) {
      double amplitude = plan.level.ceiling * shape.intensity;
      if (!boards.sounds_at(amplitude)) {
        refuse(fmt::format("the ceiling {:g} times the {} {:.3g} of '{}' is {:.3g}", plan.level.ceiling,
                           shape.is_spring ? "intensity at its stiffest" : "intensity", shape.intensity,
                           printable(shape.name), amplitude));
      }
      if (shape.pressure_pa &&
          !request_sounds(layout, boards, plan.level.ceiling, shape.intensity, *shape.pressure_pa, amplitude)) {
        refuse(fmt::format("the ceiling {:g} times the amplitude for the {:g} Pa of '{}' is {:.3g}", plan.level.ceiling,
                           *shape.pressure_pa, printable(shape.name), amplitude));
      }
    }
  }
}

std::string doubt_of_reading(const StudyPlan& plan, const EarLevel& level) {
  if (!level.measured || *level.measured > level.predicted_db() - reflections_db) return {};
  return fmt::format(
      "{}: measured_db means {:.1f} dB at the plan's ceiling, but {:.1f} dB are predicted; a sound-level meter with an "
      "A or C filter does not hear 40 kHz",
      plan.file, *level.measured, level.predicted_db());
}

const std::vector<EarLimit>& ear_limits() {
  static const std::vector<EarLimit> limits{
      {"IRPA/INIRC 1984, AGNIR 2010", "the public", 100},
      {"IRPA/INIRC 1984, AGNIR 2010", "at work", 110},
      {"Poland", "at work, equivalent for 8 hours", 110},
      {"Poland", "at work, at any time", 130},
      {"ACGIH", "at work, at 40 kHz", 115},
  };
  return limits;
}

std::string needs_approval(const StudyPlan& plan, const EarLevel& level) {
  if (const double above_db = level.loudest_db() - plan.level.limit_db; above_db > 0) {
    const std::string what =
        fmt::format("{}: {:.1f} dB are {} at an ear, and the limit of the plan is {:.1f} dB: ", plan.file,
                    level.loudest_db(), level.word(), plan.level.limit_db);
    if (level.fitting_ceiling == 0)
      return what + "no ceiling at which the array sounds is quiet enough: move the participant away";
    return fmt::format(
        "{}lower the ceiling of its [level] from {} to {:g}, or move the participant away{}", what, plan.level.ceiling,
        level.fitting_ceiling,
        level.fitting_ceiling < 1e-3 ? "; see whether left_ear_mm and right_ear_mm are in millimetres" : "");
  }
  if (const double below_db = level.predicted_db() - level.loudest_db(); below_db > impossible_reading_db) {
    return fmt::format(
        "{}: measured_db is {:.0f} dB below the prediction, so it is not of this sound: measure again, or leave it out",
        plan.file, below_db);
  }
  return {};
}

void check_signature(const StudyPlan& plan, const EarLevel& level, const std::string& signature) {
  if (!signature.empty() && needs_approval(plan, level).empty())
    throw bad_usage("--override has no effect: the level is within the plan's limit; leave it out");
  if (const std::string doubt = doubt_of_reading(plan, level); !doubt.empty()) log::warning(doubt);
}

void refuse_loud(const StudyPlan& plan, const EarLevel& level, const std::string& signature) {
  if (!signature.empty() && signature.find_first_not_of(" \t\r\n") == std::string::npos)
    throw bad_usage("--override is blank: say who accepted the level, such as the number of an ethics decision");
  if (const std::string why = needs_approval(plan, level); !why.empty() && signature.empty()) throw bad_usage(why);
}

}  // namespace palpa::study
