// The pressure on the skin of one focus at a time at places of the foci's path: the basis of spectra (spectrum.hpp) and
// tuning (tune.hpp). In free air it is an array's field (array_field.hpp), on a finger the sound that this finger
// scatters (finger_field.hpp). Without either, a focus is a Gaussian spot, whose width is the same for every array and
// direction (SpectrumOptions).
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa::acoustics {

/// The model of a focus.
enum class FocusKind { spot, array, finger };
inline constexpr Word<FocusKind> focus_kind_words[] = {
    {"spot", FocusKind::spot}, {"array", FocusKind::array}, {"finger", FocusKind::finger}};

class FocusField {
 public:
  virtual ~FocusField() = default;

  virtual FocusKind kind() const = 0;

  /// Steps of this length along a path resolve the field completely: a sixth of the wavelength, because |p|^2 has no
  /// detail finer than half a wavelength.
  virtual double step_m() const = 0;

  /// The point of the skin that a place of the path refers to.
  virtual Vec3 skin_at(const Vec3& place) const { return place; }

  /// Replaces `pressures` by the radiation pressure of the foci path[0], path[every], path[2 every] ... at all places
  /// of `path`, entry [focus * path.size() + place], in arbitrary units that all entries share. Positions are within
  /// 100 m. Returns false, with a meaningless result, if `give_up` became true meanwhile.
  virtual bool felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
                    const std::atomic<bool>* give_up = nullptr) const = 0;
};

inline FocusKind kind_of(const FocusField* field) {
  return field ? field->kind() : FocusKind::spot;
}

/// The maximum number of places of a path, unless it has more foci.
inline constexpr std::size_t most_path_places = 128;

/// The closed polygon through `foci`, each side in `per_side` equal steps: place focus * per_side is that focus.
std::vector<Vec3> path_through(std::span<const Vec3> foci, std::size_t per_side);

/// The number of steps per side so that the longest step is at most `step_m`; fewer if the path would otherwise have
/// more than most_path_places in all.
std::size_t steps_per_side(std::span<const Vec3> foci, double step_m);

}  // namespace palpa::acoustics
