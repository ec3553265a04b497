// How finely pictures are drawn, and when. Four samples for each pixel keep edges smooth; a device that is a processor,
// or slow, takes long over them. There a picture in motion has one, and what rests is drawn once more with four.
#pragma once

#include <optional>

#include "base/words.hpp"

namespace palpa::viewer {

enum class Fineness {
  quick,  ///< one sample; of very many skin points only each so-manyth
  fine,   ///< four, where the device has them
};

/// Which pictures of a window are fine.
enum class FinePictures {
  automatic,  ///< where they take long, those of what rests; else all
  always,
  never,
};
inline constexpr Word<FinePictures> fine_words[] = {
    {"auto", FinePictures::automatic}, {"always", FinePictures::always}, {"never", FinePictures::never}};

/// A fine picture that takes longer than that is too slow for what moves.
inline constexpr double slow_picture_ms = 40;

/// Chooses for one picture after the other.
class Rest {
 public:
  /// What has not changed for so long rests.
  static constexpr double rest_s = 0.15;

  /// Of the next picture, at `now_s`: `changed` says whether something in it is another than in the last, `slow`
  /// whether fine pictures take long.
  Fineness next(FinePictures wanted, bool slow, bool changed, double now_s) const {
    if (wanted != FinePictures::automatic) return wanted == FinePictures::always ? Fineness::fine : Fineness::quick;
    const bool moves = changed && drawn_s_ && now_s < *drawn_s_ + rest_s;
    return slow && moves ? Fineness::quick : Fineness::fine;
  }
  /// It has been drawn.
  void drew(FinePictures wanted, Fineness fineness, double now_s) {
    drawn_s_ = now_s;
    again_ = wanted == FinePictures::automatic && fineness == Fineness::quick;
  }
  /// When the last picture is to be drawn once more, finely; nothing: it is as it should be.
  std::optional<double> again_s() const { return again_ ? std::optional(*drawn_s_ + rest_s) : std::nullopt; }

 private:
  std::optional<double> drawn_s_;
  bool again_ = false;
};

}  // namespace palpa::viewer
