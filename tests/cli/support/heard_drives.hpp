// Drives that `--link record:FILE` wrote, and the focus that they had.
#pragma once

#include <filesystem>

#include "array/drive.hpp"
#include "base/math.hpp"

namespace palpa::test {

/// The last drive that sounds. gtest: the recording must end in silence after it.
array::Drive last_sound(const std::filesystem::path& recording);

/// How far the phases are from those of a focus there, at most, radians, with an OpenMPD board that stands so.
double phases_off(const array::Drive& drive, const Transform& T_world_layout, const Vec3& focus);

}  // namespace palpa::test
