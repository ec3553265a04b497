// The radiation pressure of an array around a focus: one focus at a time, at places on the path of the foci. Free
// field, linear, no absorption, no finger in the way. With the drive q_j for focus j alone (array/drive.hpp), the
// pressure at the place y is
//
//   p_j(y) = sum over transducers of q_j D(angle) e^{ikr} / r,   felt in proportion to |p_j(y)|^2.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/field/focus_field.hpp"
#include "array/drive_options.hpp"
#include "array/field/farthest.hpp"
#include "array/field/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

class ArrayField final : public FocusField {
 public:
  /// The layout is posed in the frame of the foci and must outlive it. Only four of the drive's options matter: medium,
  /// directivity, weighting and constraint. They determine each transducer's drive for one focus.
  ArrayField(const array::Layout& layout, const array::DriveOptions& drive);

  FocusKind kind() const override { return FocusKind::array; }
  double step_m() const override { return step_m_; }

  /// Costs a term for every entry and transducer. Any number of threads may call it at a time.
  bool felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
            const std::atomic<bool>* give_up = nullptr) const override;

 private:
  const array::Layout& layout_;
  array::Weighting weighting_;
  array::FreeField transfer_;
  array::FarthestTransducer farthest_;
  double step_m_;
};

}  // namespace palpa::acoustics
