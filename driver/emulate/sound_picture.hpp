// The sound that boards' bytes make, as text: where it is loudest, and a vertical cut through that place.
#pragma once

#include <span>
#include <string>

#include "acoustics/field/incident.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"

namespace palpa::driver::emulate {

/// Where the sound of a drive is loudest in front of the boards, layout frame.
struct Loudest {
  Vec3 place;
  double pascals = 0;  ///< peak; 0: silence
};

class SoundPicture {
 public:
  /// Of this layout, which outlives it; 20 degrees, T4010A1.
  explicit SoundPicture(const array::Layout& layout);
  /// To a tenth of a millimetre, where what is loudest is a focus.
  Loudest loudest(std::span<const array::TransducerDrive> drive) const;
  /// A line that says where and how loud, and below it |p| around there: x to the right, z upward, y as the line says.
  std::string picture(std::span<const array::TransducerDrive> drive) const;

 private:
  std::vector<double> pressures(std::span<const Vec3> points, std::span<const array::TransducerDrive> drive) const;

  acoustics::Incident incident_;
  Vec3 low_, high_;  ///< what is looked at
};

}  // namespace palpa::driver::emulate
