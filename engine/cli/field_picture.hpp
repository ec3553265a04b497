// The picture that `palpa field --png` draws of a plane.
#pragma once

#include <string>

#include "setup/tasks/field.hpp"

namespace palpa::cli {

/// Draws |p| on the plane of `field`, which was computed from `task`, into the PNG `file`: colours with a bar in Pa,
/// axes in mm. Above the pressure up to which linear acoustics holds, colours show only values relative to the largest.
/// Throws failure() if the file cannot be written.
void draw_field(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task);

}  // namespace palpa::cli
