#include "experiment/observe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <map>
#include <span>
#include <utility>

#include "acoustics/felt/skin.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/layouts/board_play.hpp"
#include "base/activity.hpp"
#include "base/system/parallel.hpp"
#include "experiment/level.hpp"
#include "experiment/response_cache.hpp"
#include "experiment/touch_patterns.hpp"
#include "observer/placements.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::experiment {
namespace {

/// Spikes of every model at every site within the counting window.
std::vector<float> counts_of(const observer::SkinMotion& motion, double factor) {
  const std::size_t sites = motion.velocity.sites();
  std::vector<float> counts(sites * observer::model_count);
  for (std::size_t m = 0; m < observer::model_count; ++m) {
    const observer::Spikes spikes =
        observer::respond(motion, observer::afferent_models()[m], factor, observer::settling_samples);
    for (std::size_t s = 0; s < sites; ++s)
      counts[s * observer::model_count + m] = static_cast<float>(spikes.counts[s]);
  }
  return counts;
}

/// Root mean square over time of the deflection at each site, its lines weighted by a sensitivity.
std::vector<float> felt_at(const observer::SkinUnderPattern::Lines& lines, double (*sensitivity)(double hz)) {
  std::vector<float> felt;
  for (std::size_t begin = 0; begin < lines.amplitudes.size(); begin += lines.hz.size()) {
    double square = 0;
    for (std::size_t m = 0; m < lines.hz.size(); ++m)
      square += std::pow(lines.amplitudes[begin + m] * sensitivity(lines.hz[m]), 2) / 2;
    felt.push_back(static_cast<float>(std::sqrt(square)));
  }
  return felt;
}

/// The response to one pattern at these levels, with all that the variants of the observer need.
observer::TouchResponse respond_to(const observer::SkinLoad& waves, const observer::SkinLoad& at_once,
                                   const observer::PressurePattern& pattern, const std::vector<double>& factors) {
  observer::TouchResponse response;
  if (pattern.slots.empty()) return response;
  const observer::SkinUnderPattern skin(waves, pattern, observer::observed_samples);
  const observer::SkinMotion motion = skin.motion();
  for (const double factor : factors)
    response.counts.push_back(counts_of(motion, factor));
  const observer::SkinUnderPattern rigid(at_once, pattern, observer::observed_samples);
  response.at_once = counts_of(rigid.motion(), factors[0]);
  const std::vector<double> stress = skin.mean_stress();
  response.mean_stress.assign(stress.begin(), stress.end());
  const observer::SkinUnderPattern::Lines lines = skin.lines();
  response.flutter = felt_at(lines, acoustics::flutter_sensitivity);
  response.vibration = felt_at(lines, acoustics::vibration_sensitivity);
  return response;
}

/// The models and arrays of a plan, each loaded once.
struct Loaded {
  std::list<std::vector<geometry::Solid>> solids;
  std::vector<TouchedScene> shapes;
  std::map<std::string, array::Layout> layouts;
  std::vector<ObservedMethod> methods;

  explicit Loaded(const study::StudyPlan& plan) {
    for (const study::PlanShape& shape : plan.shapes) {
      std::vector<geometry::Solid>& loaded = solids.emplace_back(setup::load_solids(shape.model));
      // The plan says how shapes are to be felt, so that methods differ by their names only.
      for (geometry::Solid& solid : loaded)
        solid.haptics = {};
      shapes.push_back({shape.model, loaded});
    }
    for (const auto* list : {&plan.methods, &plan.candidates}) {
      for (const study::PlanMethod& method : *list) {
        const auto found = layouts.find(method.layout);
        const array::Layout& layout =
            found != layouts.end()
                ? found->second
                : layouts.emplace(method.layout, setup::load_posed_layout(method.layout)).first->second;
        methods.push_back({method, &layout});
      }
    }
  }
};

/// The pressure at a focus in the middle of the objects' top at that ceiling, with the amplitudes that the array's
/// boards have, relative to that of the ideal drive at full amplitude.
double played_part(const array::Layout& layout, double ceiling) {
  const array::SlotFocus focus{};
  array::Drive drive = array::drive_for(layout, {&focus, 1}, {.weighting = layout.amplitude_law});
  const double full_pa = std::abs(acoustics::pressure_at(layout, drive, focus.position));
  for (array::TransducerDrive& transducer : drive)
    transducer.amplitude *= static_cast<float>(ceiling);
  array::BoardPlay(layout).round(drive, ceiling);
  return std::abs(acoustics::pressure_at(layout, drive, focus.position)) / full_pa;
}

/// Quiet sound is as linear acoustics says. Loud sound is no stronger than at the calibrated level.
double crest_force_n(const study::StudyPlan& plan, const array::Layout& layout, const Calibration& calibration) {
  const double part = played_part(layout, plan.level.ceiling);
  return std::min(part * part * calibration.linear_crest_n, plan.observer.crest_n);
}

/// Touches of one method that are to be computed, and where they go.
struct MissingResponses {
  ObservedMethod method;
  CacheKey key;
  ShapeResponses& into;
};

struct TouchList {
  const std::vector<double>& depths_m;
  const std::vector<observer::FingerPlace>& places;
  const std::vector<double>& factors;
};

/// Touches a shape with several methods, and keeps the responses. Advances `activity` once per depth and place.
void touch_shape(ObservedFinger& finger, const TouchedScene& shape, const TouchList& list,
                 std::span<MissingResponses> missing, Activity& activity) {
  if (missing.empty()) return;
  std::vector<ObservedMethod> methods;
  for (MissingResponses& one : missing) {
    methods.push_back(one.method);
    one.into.resize(list.depths_m.size() * list.places.size());
  }
  const observer::SkinLoad &waves = finger.load(observer::Delays::waves),
                           &at_once = finger.load(observer::Delays::none);
  std::size_t first = 0;
  for (const double depth : list.depths_m) {
    std::vector<std::vector<TouchPattern>> patterns;
    for (const observer::FingerPlace& place : list.places) {
      patterns.push_back(touch_patterns(finger, {shape.file, shape.solids, depth}, place, methods));
      activity.advance();
    }
    parallel_chunks(list.places.size() * methods.size(), 1, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t place = i / methods.size(), m = i % methods.size();
        missing[m].into[first + place] = respond_to(waves, at_once, patterns[place][m].pattern, list.factors);
      }
    });
    first += list.places.size();
  }
  for (const MissingResponses& one : missing)
    store_responses(one.key, one.into);
}

}  // namespace

double crest_force_n(const study::StudyPlan& plan, ObservedFinger& finger) {
  const array::Layout layout = setup::load_posed_layout(plan.methods[plan.fit.method].layout);
  return crest_force_n(plan, layout, kept_level(finger, layout));
}

double ceiling_for_n(const study::StudyPlan& plan, double crest_n, ObservedFinger& finger) {
  const array::Layout layout = setup::load_posed_layout(plan.methods[plan.fit.method].layout);
  return std::sqrt(crest_n / kept_level(finger, layout).linear_crest_n);
}

observer::Responses observe(const study::StudyPlan& plan, ObservedFinger& finger) {
  const Loaded loaded(plan);
  const array::Layout& fitted = *loaded.methods[plan.fit.method].layout;
  const Calibration calibration = kept_level(finger, fitted);
  observer::Responses out;
  out.depths_m = plan.observer.depths_m;
  out.placements = plan.observer.placements;
  out.areas_cm2 = finger.sites().areas_cm2;
  out.seconds_counted = (observer::observed_samples - observer::settling_samples) / observer::afferent_rate_hz;
  for (const study::PlanShape& shape : plan.shapes)
    out.shapes.push_back(shape.name);
  std::vector<double> factors;
  const auto add_level = [&](std::string name, double factor) {
    factors.push_back(factor);
    out.levels.push_back({std::move(name), factor, factor * calibration.linear_crest_n});
  };
  const auto add_crest = [&](double newton) {
    add_level(fmt::format("{:g} mN", newton * 1e3), calibration.factor(newton));
  };
  add_crest(plan.observer.crest_n);
  for (const double newton : plan.observer.other_crests_n)
    add_crest(newton);
  const double of_plan = crest_force_n(plan, fitted, calibration);
  add_level(fmt::format("plan ({:.2g} mN)", of_plan * 1e3), calibration.factor(of_plan));
  out.levels.back().plan_ceiling = plan.level.ceiling;
  add_level("linear", 1);
  const std::vector<observer::FingerPlace> places =
      observer::places_of({plan.observer.lateral_m, plan.observer.yaw_rad}, plan.observer.placements);

  // In the order of the result: by method, then by shape.
  std::vector<ShapeResponses> responses(loaded.methods.size() * loaded.shapes.size());
  const std::size_t of_a_shape = out.depths_m.size() * places.size();
  std::vector<std::vector<MissingResponses>> missing(loaded.shapes.size());
  std::size_t touches = 0;
  for (std::size_t m = 0; m < loaded.methods.size(); ++m) {
    out.methods.push_back(loaded.methods[m].method.name);
    for (std::size_t s = 0; s < loaded.shapes.size(); ++s) {
      ShapeResponses& into = responses[m * loaded.shapes.size() + s];
      const CacheKey key = key_of({finger, loaded.shapes[s].solids, out.depths_m, places, factors}, loaded.methods[m]);
      if (auto kept = load_responses(key, of_a_shape, out.areas_cm2.size(), factors.size())) {
        into = *std::move(kept);
        continue;
      }
      if (missing[s].empty()) touches += of_a_shape;
      missing[s].push_back({loaded.methods[m], key, into});
    }
  }
  if (touches > 0) {
    Activity activity("touches the shapes", touches);
    for (std::size_t s = 0; s < loaded.shapes.size(); ++s)
      touch_shape(finger, loaded.shapes[s], {out.depths_m, places, factors}, missing[s], activity);
  }
  for (ShapeResponses& one : responses) {
    for (observer::TouchResponse& response : one)
      out.touches.push_back(std::move(response));
  }
  return out;
}

}  // namespace palpa::experiment
