// Where only every n-th pixel of every n-th row of depth frames is looked at: what that changes, and how far it may go.
#pragma once

#include <cstdint>
#include <span>

#include "base/math.hpp"
#include "sensing/rays.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// A finger has stride^2 times fewer contacts, so that fewer make one: min_points divided by as much, and no fewer than
/// 3 (min_points where that is fewer), which a cross-section needs. Nothing else changes: the gap between clusters is a
/// distance, and what splits, joins or drops clusters looks at all pixels of the frames.
Parameters at_stride(Parameters parameters, std::uint32_t stride);

/// The largest stride, up to 4, at which pixels that are looked at still lie within the finger gap on skin that is
/// turned 45 degrees from the camera, where it is farthest in `box` (world). 1: not even the next one.
std::uint32_t most_pixel_stride(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
                                const Box& box, const Parameters& parameters);

/// The same for all crops of a frame.
void set_stride(std::span<sensing::Crop> crops, std::uint32_t stride);

}  // namespace palpa::touch
