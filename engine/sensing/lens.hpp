// A camera's distortion, prepared so that it can be undone at many pixels.
#pragma once

#include <array>
#include <optional>

#include "base/math.hpp"

namespace palpa::sensing {

class Lens {
 public:
  /// With `prepare`, spends a few microseconds on bounds that make `undo` much faster.
  explicit Lens(const std::array<double, 5>& distortion, bool prepare);

  Vec2 apply(const Vec2& ray) const;
  /// The ray (x/z, y/z) whose distorted coordinates are `target`, searched from `guess`; nullopt if there is none
  /// inside the radius where the model folds back on itself.
  std::optional<Vec2> undo(const Vec2& target, const Vec2& guess) const;

 private:
  struct Value;
  Value evaluate(const Vec2& ray) const;
  std::optional<Vec2> newton(const Vec2& target, Vec2 ray) const;
  bool reachable(const Vec2& ray) const;
  void find_bounds();

  std::array<double, 5> k_;
  bool identity_;
  double safe_radius_ = 0;        ///< rays nearer to the axis come before any fold
  double target_radius_ = 1e300;  ///< distorted coordinates farther out belong to no ray
};

}  // namespace palpa::sensing
