// What an array gives around a focus: the radiation pressure of one focus at a time, at places on the path that foci
// run on. Free field, linear, no absorption, no finger in its way: of the drive q_j that focus j asks for alone
// (array/drive.hpp) the place y hears
//
//   p_j(y) = sum over transducers of q_j D(angle) e^{ikr} / r,   felt in proportion to |p_j(y)|^2.
//
// It takes the place of a Gaussian spot (SpectrumOptions), whose width is the same for every array and direction.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/reach.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

class ArrayField {
 public:
  /// Of this layout as posed where the foci are, which outlives it. Of the drive's options medium, directivity,
  /// weighting and constraint count: what each transducer does for one focus.
  ArrayField(const array::Layout& layout, const array::DriveOptions& drive);

  /// In steps of this length along a path nothing of the field is lost: a sixth of the wavelength, since |p|^2 has no
  /// detail finer than half of it.
  double step_m() const { return step_m_; }

  /// Replaces `pressures` by the radiation pressure of the foci path[0], path[every], path[2 every] ... at all places
  /// of `path`, entry [focus * path.size() + place], in arbitrary units that all entries share. It has a term for every
  /// entry and transducer. Positions are within 100 m. Any number of threads may call it at a time. False, and nothing
  /// of use, if `give_up` became true meanwhile.
  bool felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
            const std::atomic<bool>* give_up = nullptr) const;

 private:
  const array::Layout& layout_;
  array::Weighting weighting_;
  array::FreeField transfer_;
  array::Reach reach_;
  double step_m_;
};

/// Places that a path has at most, as long as it has no more foci than that.
inline constexpr std::size_t most_path_places = 128;

/// The closed polygon through `foci`, each side in `per_side` equal steps: place focus * per_side is that focus.
std::vector<Vec3> path_through(std::span<const Vec3> foci, std::size_t per_side);

/// How many steps a side takes for the longest of them to be no longer than `step_m`; fewer where that were more than
/// most_path_places in all.
std::size_t steps_per_side(std::span<const Vec3> foci, double step_m);

}  // namespace palpa::acoustics
