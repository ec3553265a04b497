// The picture that `palpa field --png` draws of a plane.
#pragma once

#include <string>

#include "setup/tasks/field.hpp"

namespace palpa::cli {

/// A picture of |p| on the plane of `field`, which `task` is the source of, into that PNG: colours with a bar in Pa,
/// axes in mm. Above the pressure to which linear acoustics holds, colours say no more than what is how large beside
/// the largest. Throws failure() where the file cannot be written.
void draw_field(const std::string& file, const setup::FieldResult& field, const setup::FieldTask& task);

}  // namespace palpa::cli
