// What skin has of one focus at a time at places of the path that foci run on: what spectra (spectrum.hpp) and tuning
// (tune.hpp) are made of. In free air it is an array's field (array_field.hpp), on a finger the sound that this finger
// scatters (finger_field.hpp). Without either a focus is a Gaussian spot, whose width is the same for every array and
// direction (SpectrumOptions).
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa::acoustics {

/// What a focus is taken for.
enum class FocusKind { spot, array, finger };
inline constexpr Word<FocusKind> focus_kind_words[] = {
    {"spot", FocusKind::spot}, {"array", FocusKind::array}, {"finger", FocusKind::finger}};

class FocusField {
 public:
  virtual ~FocusField() = default;

  virtual FocusKind kind() const = 0;

  /// In steps of this length along a path nothing of the field is lost: a sixth of the wavelength, since |p|^2 has no
  /// detail finer than half of it.
  virtual double step_m() const = 0;

  /// Where skin has what is said of a place of the path.
  virtual Vec3 skin_at(const Vec3& place) const { return place; }

  /// Replaces `pressures` by the radiation pressure of the foci path[0], path[every], path[2 every] ... at all places
  /// of `path`, entry [focus * path.size() + place], in arbitrary units that all entries share. Positions are within
  /// 100 m. False, and nothing of use, if `give_up` became true meanwhile.
  virtual bool felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
                    const std::atomic<bool>* give_up = nullptr) const = 0;
};

inline FocusKind kind_of(const FocusField* field) {
  return field ? field->kind() : FocusKind::spot;
}

/// Places that a path has at most, as long as it has no more foci than that.
inline constexpr std::size_t most_path_places = 128;

/// The closed polygon through `foci`, each side in `per_side` equal steps: place focus * per_side is that focus.
std::vector<Vec3> path_through(std::span<const Vec3> foci, std::size_t per_side);

/// How many steps a side takes for the longest of them to be no longer than `step_m`; fewer where that were more than
/// most_path_places in all.
std::size_t steps_per_side(std::span<const Vec3> foci, double step_m);

}  // namespace palpa::acoustics
