// Warns if a solver is too slow for the camera.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace palpa::session {

/// The solver `loudest` may take longer than a frame lasts. Frames are then left out, and foci follow a finger less
/// often. It is one warning, as soon as a tenth of the frames are left out for a while.
class SlowSolver {
 public:
  /// Another frame with a touch has its drives. Returns whether to warn now.
  [[nodiscard]] bool planned(std::uint64_t sequence) {
    const std::uint64_t left_out = sequence > last_ + 1 && last_ > 0 ? sequence - last_ - 1 : 0;
    last_ = sequence;
    behind_ = std::max(0.0, behind_ + static_cast<double>(left_out) - usual);
    return behind_ >= most_behind && !std::exchange(warned_, true);
  }
  /// A frame without a touch: nothing is solved.
  void idle() {
    last_ = 0;
    behind_ = 0;
  }

 private:
  static constexpr double usual = 0.1;      ///< of a frame may be left out for every frame that is not
  static constexpr double most_behind = 5;  ///< frames
  std::uint64_t last_ = 0;
  double behind_ = 0;
  bool warned_ = false;
};

}  // namespace palpa::session
