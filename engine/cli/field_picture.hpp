// The picture that `palpa field --png` draws of a plane or along a line.
#pragma once

#include <string>

#include "setup/tasks/field.hpp"

namespace palpa::cli {

/// Draws |p| of `field`, which was computed from `task` on a plane or a line, into the PNG `file`: colours with a bar
/// in Pa, or a curve, with a band if there is a spread; axes in mm. Above the pressure up to which linear acoustics
/// holds, the picture shows only values relative to the largest. Throws failure() if the file cannot be written.
void draw_field(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task);

}  // namespace palpa::cli
