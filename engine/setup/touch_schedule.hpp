// What the fingers of one touch play: foci by the method, and order and dwell, tuned where --tune asks for it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acoustics/tune.hpp"
#include "array/schedule.hpp"
#include "geometry/solid.hpp"
#include "setup/options.hpp"
#include "touch/method.hpp"

namespace palpa::setup {

struct FingerSchedule {
  touch::Placement placement;
  double perimeter_m = 0;                 ///< of the path of its foci; 0: they stand still
  array::VoiceOptions voice;              ///< its stride, dwell and modulation
  std::optional<acoustics::Tuned> tuned;  ///< with --tune, of foci that move
};

/// One entry per finger of `touch`, in their order. What a finger's solid asks for takes the place of the options, and
/// what is tuned the place of both.
std::vector<FingerSchedule> schedule_fingers(const touch::Touch& touch, std::span<const geometry::Solid> solids,
                                             const TouchOptions& options, const FeltOptions& felt);

/// Of all fingers, ids being their numbers.
array::Schedule make_schedule(const touch::Touch& touch, std::span<const geometry::Solid> solids,
                              const std::vector<FingerSchedule>& fingers, const TouchOptions& options);

/// What skin feels of each finger.
std::vector<acoustics::Spectrum> spectra_of(const array::Schedule& schedule, const FeltOptions& felt);

}  // namespace palpa::setup
