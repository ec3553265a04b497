// Where a pattern's one point is at a time, and how strong: the rules of Adaptics' evaluator, also where they surprise.
//
//   P            pattern time: goes on with the playback speed, and jumps. Keyframes are at pattern times
//   T            time since the start. The brush and the modulation run on it, so speed and jumps do not touch them
//   coords       between the last keyframe at or before P and the next one; held before a pause or a stop
//   place        scale, rotation about z, translation, then the matrix; the brush is added last, unturned
//   intensity    times the factor, times 0.5 + 0.5 cos(2 pi am T). It is not limited to 0..1
//   jump         at most one in each evaluation, from keyframes passed since the one before; the overshoot is lost
#pragma once

#include "base/math.hpp"
#include "base/random.hpp"
#include "sensation/pattern.hpp"

namespace palpa::sensation {

/// What goes on from one evaluation to the next.
struct Progress {
  double last_ms = 0;    ///< the pattern time of the evaluation before; at the start, the time at which it starts
  double offset_ms = 0;  ///< what pattern time is ahead of time
};

struct Evaluation {
  Vec3 place_mm{0};
  double intensity = 0;  ///< raw: it may be outside 0..1
  double pattern_ms = 0;
  bool stop = false;     ///< the last keyframe is a stop
  double height_mm = 0;  ///< the z of the pattern's translation
};

struct Evaluated {
  double speed = 1;                   ///< multiplies the pattern's own playback speed
  const Transform* matrix = nullptr;  ///< applied to the place before the brush; null: none
};

/// At the time `time_ms`. `random` is drawn from for random intensities only. A pattern time that is not finite is not
/// kept as progress.
Evaluation evaluate(const Pattern& pattern, const Values& values, double time_ms, Progress& progress, Random& random,
                    const Evaluated& how = {});

}  // namespace palpa::sensation
