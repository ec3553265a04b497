// How finely pictures are drawn, and when. Four samples for each pixel keep edges smooth, but take a long time on a
// slow device or a processor. On such a device, a picture that changes has one sample for each pixel. Once the picture
// is at rest, it is drawn again with four.
#pragma once

#include <optional>

#include "base/words.hpp"

namespace palpa::viewer {

enum class Fineness {
  quick,  ///< one sample; if there are very many skin points, only every n-th of them
  fine,   ///< four samples, if the device supports them
};

/// Which pictures of a window are fine.
enum class FinePictures {
  automatic,  ///< on slow devices only while nothing moves; else all
  always,
  never,
};
inline constexpr Word<FinePictures> fine_words[] = {
    {"auto", FinePictures::automatic}, {"always", FinePictures::always}, {"never", FinePictures::never}};

/// A fine picture that takes longer than this is too slow for a picture in motion.
inline constexpr double slow_picture_ms = 40;

/// Chooses the fineness of each picture.
class Rest {
 public:
  /// A picture that has not changed for this long is at rest.
  static constexpr double rest_s = 0.15;

  /// The fineness of the next picture, at `now_s`. `changed`: it differs from the last one. `slow`: fine pictures take
  /// a long time.
  Fineness next(FinePictures wanted, bool slow, bool changed, double now_s) const {
    if (wanted != FinePictures::automatic) return wanted == FinePictures::always ? Fineness::fine : Fineness::quick;
    const bool moves = changed && drawn_s_ && now_s < *drawn_s_ + rest_s;
    return slow && moves ? Fineness::quick : Fineness::fine;
  }
  /// Call when the picture has been drawn.
  void drew(FinePictures wanted, Fineness fineness, double now_s) {
    drawn_s_ = now_s;
    again_ = wanted == FinePictures::automatic && fineness == Fineness::quick;
  }
  /// The time at which the last picture must be drawn again as a fine picture; nullopt if it need not be.
  std::optional<double> again_s() const { return again_ ? std::optional(*drawn_s_ + rest_s) : std::nullopt; }

 private:
  std::optional<double> drawn_s_;
  bool again_ = false;
};

}  // namespace palpa::viewer
