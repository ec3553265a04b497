// A field for foci that request a pressure (array/loudness.hpp): each focus has the same pressure at its own place,
// however close to the array it is.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/field/focus_field.hpp"

namespace palpa::acoustics {

class AskedField final : public FocusField {
 public:
  /// `field` must outlive it.
  explicit AskedField(const FocusField& field) : field_(field) {}

  FocusKind kind() const override { return field_.kind(); }
  double step_m() const override { return field_.step_m(); }
  Vec3 skin_at(const Vec3& place) const override { return field_.skin_at(place); }
  bool felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
            const std::atomic<bool>* give_up = nullptr) const override;

 private:
  const FocusField& field_;
};

}  // namespace palpa::acoustics
