// How far the skin of a finger has moved from one frame to the next.
//
// The centroid of a finger's contacts does not show this: when a finger presses or lifts, its contacts stay at the
// surface. So the depth images themselves are compared. Each pixel of the finger says how far the skin has moved along
// its normal n there: n . way = n . (p - p'), with the point p' of the frame before at the place from which p has come.
// The least squares of all of them give the way (Chen and Medioni, "Object modelling by registration of multiple range
// images", 1992, for translations only). In directions that the skin does not determine, the way is that of the
// contacts' centroid.
#pragma once

#include <cstddef>
#include <vector>

#include "base/math.hpp"
#include "session/predict/kept_frames.hpp"

namespace palpa::session {

struct SkinStep {
  Vec3 way{0};              ///< metres, world
  std::size_t samples = 0;  ///< pixels that were compared
};

/// Fewer samples than this say nothing.
inline constexpr std::size_t least_skin_samples = 24;

/// A sampled pixel.
struct SkinSample {
  Vec3 place, normal;  ///< world; normals towards the camera
  std::size_t camera;
};

/// Scratch memory that keeps its storage.
struct SkinScratch {
  std::vector<SkinSample> samples;
  std::vector<sensing::Crop> crops;
  std::vector<shader::SkinVolume> volumes;
  std::vector<Transform> T_camera_world;
};

/// The way of the skin inside `box` since the frame `before`, near the `expected` one; `centroid` is the way of the
/// contacts' centroid. What the view knows to be no skin does not count, in either frame.
SkinStep find_skin_step(const CameraView& view, const KeptFrames& now, const KeptFrames& before, const Box& box,
                        const Vec3& expected, const Vec3& centroid, SkinScratch& scratch);

}  // namespace palpa::session
