// Drives that `--link record:FILE` wrote, and the focus that they had.
#pragma once

#include <filesystem>

#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "support/drive_recording.hpp"

namespace palpa::test {

/// The largest amplitude; 0 is silence.
float loudest(const array::Drive& drive);

/// gtest: it has drives, and the last one is all zero.
DriveRecording read_to_silence(const std::filesystem::path& recording);

/// The last drive that sounds. gtest: the recording must end in silence after it.
array::Drive last_sound(const std::filesystem::path& recording);

/// How far the phases are from those of a focus there, at most, radians, with an OpenMPD board that stands so.
double phases_off(const array::Drive& drive, const Transform& T_world_layout, const Vec3& focus);

}  // namespace palpa::test
