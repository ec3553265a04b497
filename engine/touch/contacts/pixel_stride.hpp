// The pixel stride: only every n-th pixel of every n-th row of depth frames is looked at. Its effect and its limit.
#pragma once

#include <cstdint>
#include <span>

#include "base/math.hpp"
#include "sensing/rays.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// A finger has stride^2 times fewer contacts, so min_points is divided by stride^2. The result is at least 3, which a
/// cross-section needs, or min_points if that is less. Nothing else changes: the gap between clusters is a distance,
/// and the passes that split, join or drop clusters look at all pixels of the frames.
FingerOptions at_stride(FingerOptions parameters, std::uint32_t stride);

/// The largest stride, up to 4, at which neighbouring sampled pixels still lie within the finger gap. This is computed
/// for skin that is turned 45 degrees from the camera, at its farthest place in `box` (world). 1: not even a stride of
/// 2 is possible.
std::uint32_t most_pixel_stride(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
                                const Box& box, const FingerOptions& parameters);

/// The same for all crops of a frame.
void set_stride(std::span<sensing::Crop> crops, std::uint32_t stride);

}  // namespace palpa::touch
