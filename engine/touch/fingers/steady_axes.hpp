// Axes of cross-sections that turn as little as possible from frame to frame. The rules are in docs/touch.md.
#pragma once

#include <array>

#include "touch/fingers/exact.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The covariance of a cross-section with its principal axes.
glm::mat3 covariance_of(const CrossSection& section);

/// For a finger without an earlier frame: the principal axes, unless depth shows better where they face. Signs as
/// theirs.
void take_first_axes(CrossSection& section);

/// Turns the principal axes of a cross-section to those of a finger whose w1 and w3 were `old1` and `old3`. w3 turns
/// towards the direction in which the cross-section faces, at once if that is clear. The old w1 is carried over by the
/// smallest rotation that takes the old w3 to the new one. It is then turned in the plane towards the nearer of the
/// principal directions, the more elongated the cross-section, the farther.
void take_steady_axes(CrossSection& section, const glm::vec3& old1, const glm::vec3& old3, float frame_s);

/// Turns the principal axes of a cross-section to these, whatever they are.
void take_axes(CrossSection& section, const std::array<glm::vec3, 3>& axes);

}  // namespace palpa::touch
