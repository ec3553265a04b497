#include "sensation/played.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::sensation {
namespace {

constexpr double step_ms = 0.05;
static_assert(step_s == 0.05e-3);

/// Rounded to 1e-9 ms, so that the times of keyframes, which are whole numbers of milliseconds, are met exactly.
double ms_of(double time_s) {
  constexpr double most_s = 1e3;
  return std::abs(time_s) < most_s ? std::round(1e12 * time_s) / 1e9 : 1e3 * time_s;
}

/// A place and an intensity as they may sound. Values that are not finite are silent, with one warning.
Point sounding(const Vec3& place_m, double gain, double time_s, bool& warned, const std::string& who) {
  Point point{.place_m = place_m};
  if (is_finite(place_m) && std::isfinite(gain)) {
    point.gain = std::clamp(gain, 0.0, 1.0);
    return point;
  }
  if (!std::exchange(warned, true))
    log::warning(
        fmt::format("{}: at {:.6g} s, the place or the intensity is not a finite number: silence there", who, time_s));
  point.place_m = Vec3(0);
  return point;
}

}  // namespace

PatternSensation::PatternSensation(Pattern pattern, const std::map<std::string, double>& given, double speed) {
  next_.speed = speed;
  next_.pattern = std::make_shared<const Pattern>(std::move(pattern));
  set_parameters(given);
  take_changes();
}

Evaluation PatternSensation::step_at(double time_ms, const Values& values, State& state) const {
  return evaluate(*now_.pattern, values, time_ms, state.progress, state.random,
                  {.speed = now_.speed, .matrix = now_.matrix ? &*now_.matrix : nullptr});
}

Evaluation PatternSensation::step(double time_s, const Values& values, State& state) const {
  return step_at(ms_of(time_s), values, state);
}

Point PatternSensation::point_of(const Evaluation& at, double time_s) {
  const double intensity = std::isfinite(at.pattern_ms) ? at.intensity : at.pattern_ms;
  Point point = sounding(1e-3 * at.place_mm, intensity, time_s, warned_, now_.pattern->file);
  point.height_m = std::isfinite(at.height_mm) ? 1e-3 * at.height_mm : 0;
  point.pattern_s = std::isfinite(at.pattern_ms) ? 1e-3 * at.pattern_ms : 0;
  point.stop = at.stop;
  return point;
}

/// A time between two steps is evaluated beside them, so that steps do not depend on the times that are asked for.
void PatternSensation::points(std::span<const double> times_s, State& state, std::vector<Point>& out) {
  constexpr double same_ms = 1e-7;
  const double begin_ms = ms_of(state.begin_s);
  for (const double time_s : times_s) {
    const double time_ms = ms_of(time_s);
    std::optional<Evaluation> at;
    const auto next_ms = [&] { return begin_ms + static_cast<double>(state.steps) * step_ms; };
    for (; next_ms() <= time_ms + same_ms; ++state.steps) {
      const bool met = next_ms() >= time_ms - same_ms;
      const Evaluation stepped = step_at(next_ms(), now_.values, state);
      if (met) at = stepped;
    }
    if (!at) {
      State beside = state;
      at = step_at(time_ms, now_.values, beside);
    }
    out.push_back(point_of(*at, time_s));
  }
}

bool PatternSensation::has_changes() {
  const std::lock_guard lock(mutex_);
  return changed_;
}

bool PatternSensation::take_changes() {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(changed_, false)) return false;
  now_ = next_;
  return true;
}

double PatternSensation::fastest_hz() const {
  return sensation::fastest_hz(*now_.pattern, now_.values);
}

template <typename Change>
void PatternSensation::change(Change change) {
  const std::lock_guard lock(mutex_);
  Content next = next_;
  change(next);
  next.values = values_of(*next.pattern, next.given);
  next_ = std::move(next);
  changed_ = true;
}

void PatternSensation::set_parameters(std::map<std::string, double> given) {
  change([&](Content& next) { next.given = std::move(given); });
}

void PatternSensation::set_parameter(const std::string& name, double value) {
  change([&](Content& next) { next.given[name] = value; });
}

std::vector<std::pair<std::string, double>> PatternSensation::parameters() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::string, double>> out;
  const std::vector<Parameter>& known = next_.pattern->parameters;
  for (std::size_t p = 0; p < known.size(); ++p)
    out.emplace_back(known[p].name, next_.values.value[p]);
  return out;
}

void PatternSensation::set_pattern(Pattern pattern) {
  change([&](Content& next) { next.pattern = std::make_shared<const Pattern>(std::move(pattern)); });
}

void PatternSensation::set_speed(double speed) {
  change([&](Content& next) { next.speed = speed; });
}

void PatternSensation::set_matrix(const Transform& matrix) {
  change([&](Content& next) { next.matrix = matrix; });
}

void FunctionSensation::points(std::span<const double> times_s, State&, std::vector<Point>& out) {
  places_.clear();
  gains_.clear();
  function_(times_s, places_, gains_);
  if (places_.size() != times_s.size() || gains_.size() != times_s.size()) {
    throw bad_usage(fmt::format("the sensation's function gave {} places and {} gains for {} times", places_.size(),
                                gains_.size(), times_s.size()));
  }
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    out.push_back(sounding(places_[i], gains_[i], times_s[i], warned_, "the sensation's function"));
    out.back().pattern_s = times_s[i];
  }
}

}  // namespace palpa::sensation
