// `--source fed:PORT`: the rig's depth cameras behind palpa's own code for V4L2, but another program says over UDP when
// one has a frame, and what is wrong with it.
#pragma once

#include "session/links/sources.hpp"

namespace palpa::soak {

/// Each datagram to 127.0.0.1:PORT is a line:
///
///     frame CAMERA TIME PICTURE KIND    the camera has captured this picture at this time of CLOCK_MONOTONIC
///     pull CAMERA                       it is unplugged
///     plug CAMERA                       it comes back, under another node
///
/// Picture 0 has no finger. Pictures 1 to `depths` have one fingertip at x = z = 0, whose depth below y = 0 grows by
/// `step_m` from picture to picture, from `least_depth_m` on. The next `depths` pictures have twenty of them.
/// KIND: whole, cut (the lower half is missing), damaged (marked so by the driver), noise (any depths).
session::SourceKind fed_cameras();

inline constexpr int depths = 25;
inline constexpr double least_depth_m = -8e-3, step_m = 5e-4;

}  // namespace palpa::soak
