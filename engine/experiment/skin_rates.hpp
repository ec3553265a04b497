// The rates of the afferents in a fingertip while a plan plays, for drawing them beside the pressure. The computation
// is that of `palpa afferents` (docs/afferents.md), at its usual level and duration.
#pragma once

#include <atomic>
#include <optional>

#include "acoustics/bodies/body_cache.hpp"
#include "array/layouts/layout.hpp"
#include "experiment/observed_finger.hpp"
#include "session/previews/skin_preview.hpp"

namespace palpa::experiment {

/// Keeps what depends on finger and array only. For one thread at a time.
class SkinRates {
 public:
  /// The answer of session::answer() and, if they are asked for, the rates. The finger's body is along its own y axis,
  /// its tip is its lowest vertex there. Throws as session::answer() does, and bad_input if the finger has no skin near
  /// its tip, if the plan's schedule repeats too late, or if the array reaches no finger on the paper's cube, so that
  /// there is no level.
  session::SkinAnswer answer(const session::SkinQuestion& question, acoustics::BodyCache& bodies,
                             const std::atomic<bool>* give_up = nullptr);

 private:
  void prepare(const session::SkinQuestion& question, acoustics::BodyCache& bodies, const std::atomic<bool>* give_up);

  std::optional<ObservedFinger> finger_;
  array::Layout layout_;  ///< that factor_ is of
  double factor_ = 0;     ///< on the linear pressures
};

}  // namespace palpa::experiment
