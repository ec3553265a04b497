// The settings of a stage, given once when it is made.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "base/math.hpp"
#include "sensing/surroundings.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

class KeptSolids;  // contacts/prepared_solids.hpp

/// Shorter than the time that FrameClock reports if a clock is set back.
inline constexpr double longest_memory_s = 3600;

/// The rules of hysteresis. Tools that compare them leave some out.
struct HysteresisRules {
  bool few = true;       ///< a known finger needs half as many contacts and firm ones
  bool islands = true;   ///< a small island waits: beside a known finger, or with few contacts
  bool apart = true;     ///< known fingers stay apart
  bool together = true;  ///< a known finger stays one
  bool edges = true;     ///< contacts of a finger about to end reach beyond the shell's edges
  bool falling = true;   ///< `few` and `edges` do not hold a finger that leaves
  bool whole = true;     ///< skin that parts from a known finger is the finger's until it is one
  bool again = true;     ///< skin that has just left waits, unless it presses
  bool members = true;   ///< contacts that join or leave a finger are no motion of it

  bool operator==(const HysteresisRules&) const = default;
};
inline constexpr HysteresisRules no_rules{false, false, false, false, false, false, false, false, false};

struct StageSetting {
  FingerOptions parameters;
  /// Fingers keep their ids from frame to frame; frames must come in the order of their capture. If false, each frame
  /// stands alone and the next five members have no effect.
  bool follow = false;
  Axes axes = Axes::steady;
  Smoothing smoothing = Smoothing::one_euro;
  /// Needs `follow` and cameras. Unless it is off, the rules below count.
  Hysteresis hysteresis = Hysteresis::off;
  HysteresisRules rules{};
  /// How long a finger that no camera sees is remembered, at least 0.3 s. It must not be shorter than the longest time
  /// between frames.
  double memory_s = 0;
  /// With depth frames: points on these things, and outside the room, are no skin.
  sensing::Surroundings surroundings{};

  std::uint32_t memory_us() const {
    return static_cast<std::uint32_t>(std::clamp(memory_s, 0.3, longest_memory_s) * 1e6);
  }
  bool glides() const { return follow && smoothing == Smoothing::one_euro; }
  /// Whether depth frames, if there are `cameras`, decide which clusters are fingers: clusters of several fingers are
  /// split, and patches are joined across hidden skin.
  bool looks_again(bool cameras) const { return cameras && parameters.finger_width_m > 0; }

  /// Whether the fingers of the frame before decide with the depth frames.
  bool knows(bool cameras) const { return follow && hysteresis == Hysteresis::on && looks_again(cameras); }
  /// With known fingers, clusters with half as many contacts may be fingers.
  FingerOptions searched(const FingerOptions& given, bool cameras) const {
    FingerOptions p = given;
    if (knows(cameras) && rules.few) p.min_points = (std::max(p.min_points, 1U) + 1) / 2;
    return p;
  }

  /// The box in which skin is looked for: that of the solids, and a little more if contacts reach beyond the shell.
  Box watched(Box box, bool cameras) const {
    constexpr double more_m = 0.6e-3;
    if (!knows(cameras) || !rules.edges || box.empty()) return box;
    box.low -= more_m;
    box.high += more_m;
    return box;
  }

  /// Where the prepared solids are kept for other stages of the same solids. Null: nowhere.
  std::shared_ptr<KeptSolids> kept_solids{};

  // On the device only: the maximum numbers of one frame. If a frame has more, finish() reports an error. 0: the stage
  // decides. With cameras, it has room for every pixel and for 262,144 contacts. For points from another source, there
  // is as much room as they need, even if all of them are contacts.
  std::uint32_t most_points = 0;  ///< at most shader::contacts_most_points
  std::uint32_t most_contacts = 0;
};

}  // namespace palpa::touch
