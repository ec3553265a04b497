#include "sensation/evaluate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace palpa::sensation {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

bool holds(const Jump& jump, const Values& values) {
  if (!values.known[jump.parameter]) return false;
  const double value = values.value[jump.parameter];
  switch (jump.is) {
    case Jump::Operator::lt:
      return value < jump.value;
    case Jump::Operator::lt_eq:
      return value <= jump.value;
    case Jump::Operator::gt:
      return value > jump.value;
    case Jump::Operator::gt_eq:
      return value >= jump.value;
  }
  return false;
}

const Jump* jump_between(const Pattern& pattern, const Values& values, double after_ms, double until_ms) {
  const auto first = std::ranges::upper_bound(pattern.keyframes, after_ms, {}, &Keyframe::time_ms);
  for (auto k = first; k != pattern.keyframes.end() && k->time_ms <= until_ms; ++k) {
    for (const Jump& jump : k->jumps) {
      if (holds(jump, values)) return &jump;
    }
  }
  return nullptr;
}

/// The pattern time at `time_ms`.
double advance(const Pattern& pattern, const Values& values, double time_ms, Progress& progress, double speed) {
  const double delta = time_ms + progress.offset_ms - progress.last_ms;
  const double offset = progress.offset_ms + speed * pattern.playback_speed.at(values.value) * delta - delta;
  const double at = time_ms + offset;
  if (!std::isfinite(at)) return at;
  if (const Jump* jump = jump_between(pattern, values, progress.last_ms, at)) {
    progress = {jump->to_ms, jump->to_ms - time_ms};
  } else {
    progress = {at, offset};
  }
  return time_ms + progress.offset_ms;
}

/// The weights of the earlier and of the later keyframe.
std::pair<double, double> weights(double at_ms, const Found& a, const Found& b, Transition transition) {
  const double u = (at_ms - a.time_ms) / (b.time_ms - a.time_ms);
  if (transition == Transition::linear) return {1 - u, u};
  return u < 1 ? std::pair(1.0, 0.0) : std::pair(0.0, 1.0);
}

Vec3 coords_at(const Pattern& pattern, double at_ms, std::size_t passed) {
  const Found& a = pattern.before[passed].coords;
  const Found& b = pattern.after[passed].coords;
  if (a.keyframe < 0) return Vec3(0);
  const auto& here = *pattern.keyframes[static_cast<std::size_t>(a.keyframe)].coords;
  const bool moves = passed < pattern.keyframes.size() && pattern.keyframes[passed].kind == Keyframe::Kind::standard &&
                     b.keyframe >= 0;
  if (!moves) return here.value;
  const auto [wa, wb] = weights(at_ms, a, b, here.transition);
  return wa * here.value + wb * pattern.keyframes[static_cast<std::size_t>(b.keyframe)].coords->value;
}

double drawn(const Intensity& intensity, const Values& values, Random& random) {
  const double low = intensity.low.at(values.value);
  if (!intensity.random) return low;
  return random.uniform() * (intensity.high.at(values.value) - low) + low;
}

double intensity_at(const Pattern& pattern, const Values& values, double at_ms, std::size_t passed, Random& random) {
  const Found& a = pattern.before[passed].intensity;
  const Found& b = pattern.after[passed].intensity;
  if (a.keyframe < 0) return 0;
  const auto& here = *pattern.keyframes[static_cast<std::size_t>(a.keyframe)].intensity;
  const double from = drawn(here.value, values, random);
  if (b.keyframe < 0) return from;
  const auto& there = *pattern.keyframes[static_cast<std::size_t>(b.keyframe)].intensity;
  const double to = drawn(there.value, values, random);
  const auto [wa, wb] = weights(at_ms, a, b, here.transition);
  return wa * from + wb * to;
}

/// What two brushes of one kind blend: rotation in radians, sizes, modulation.
struct Blended {
  double rotation = 0, size = 0, am_hz = 0;
};
Blended blended_of(const Brush& brush, const Values& values) {
  const double rotation = brush.rotation.at(values.value);
  return {brush.kind == Brush::Kind::line ? rotation / 180 * std::numbers::pi : rotation, brush.size.at(values.value),
          brush.am_hz.at(values.value)};
}

struct Stroke {
  Vec2 offset_mm{0};
  double modulation = 1;
};

Stroke brush_at(const Pattern& pattern, const Values& values, double time_ms, double at_ms, std::size_t passed) {
  const Found& a = pattern.before[passed].brush;
  const Found& b = pattern.after[passed].brush;
  if (a.keyframe < 0) return {};
  const auto& here = *pattern.keyframes[static_cast<std::size_t>(a.keyframe)].brush;
  const Brush& brush = here.value;
  Blended mix = blended_of(brush, values);
  if (b.keyframe >= 0) {
    const Brush& next = pattern.keyframes[static_cast<std::size_t>(b.keyframe)].brush->value;
    if (next.kind == brush.kind) {
      const Blended other = blended_of(next, values);
      const auto [wa, wb] = weights(at_ms, a, b, here.transition);
      mix = {wa * mix.rotation + wb * other.rotation, wa * mix.size + wb * other.size,
             wa * mix.am_hz + wb * other.am_hz};
    }
  }
  const double w = std::fmod(time_ms / 1000 * brush.stm_hz.at(values.value) * two_pi, two_pi);
  Vec2 at(0);
  if (brush.kind == Brush::Kind::circle) {
    at = {mix.size * std::cos(w), mix.size * std::sin(w)};
  } else if (brush.kind == Brush::Kind::line) {
    at = {mix.size * std::cos(w), 0};
  } else {
    at = {brush.x_scale.at(values.value) * std::sin(brush.a.at(values.value) * w + brush.d.at(values.value)),
          brush.y_scale.at(values.value) * std::sin(brush.b.at(values.value) * w)};
  }
  const double c = std::cos(mix.rotation), s = std::sin(mix.rotation);
  return {{at.x * c - at.y * s, at.x * s + at.y * c}, std::cos(mix.am_hz * (time_ms / 1000) * two_pi) * 0.5 + 0.5};
}

Vec3 transformed(const Pattern& pattern, const Values& values, const Vec3& coords, const Transform* matrix) {
  const auto of = [&](const Number& number) { return number.at(values.value); };
  const Vec3 scaled(coords.x * of(pattern.scale.x), coords.y * of(pattern.scale.y), coords.z * of(pattern.scale.z));
  const double turn = of(pattern.rotation) / 180 * std::numbers::pi;
  const double c = std::cos(turn), s = std::sin(turn);
  const Vec3 place(scaled.x * c - scaled.y * s + of(pattern.translate.x),
                   scaled.x * s + scaled.y * c + of(pattern.translate.y), scaled.z + of(pattern.translate.z));
  if (matrix == nullptr) return place;
  const Vec4 h = *matrix * Vec4(place, 1.0);
  return Vec3(h.x / h.w, h.y / h.w, h.z / h.w);
}

}  // namespace

Evaluation evaluate(const Pattern& pattern, const Values& values, double time_ms, Progress& progress, Random& random,
                    const Evaluated& how) {
  Evaluation out;
  out.pattern_ms = advance(pattern, values, time_ms, progress, how.speed);
  const auto next = std::ranges::upper_bound(pattern.keyframes, out.pattern_ms, {}, &Keyframe::time_ms);
  const auto passed = static_cast<std::size_t>(next - pattern.keyframes.begin());
  const Vec3 coords = coords_at(pattern, out.pattern_ms, passed);
  const Stroke stroke = brush_at(pattern, values, time_ms, out.pattern_ms, passed);
  out.intensity = intensity_at(pattern, values, out.pattern_ms, passed, random) *
                  pattern.intensity_factor.at(values.value) * stroke.modulation;
  out.place_mm = transformed(pattern, values, coords, how.matrix) + Vec3(stroke.offset_mm, 0);
  out.height_mm = pattern.translate.z.at(values.value);
  out.stop = passed > 0 && pattern.keyframes[passed - 1].kind == Keyframe::Kind::stop;
  return out;
}

}  // namespace palpa::sensation
