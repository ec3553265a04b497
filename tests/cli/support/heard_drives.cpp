#include "cli/support/heard_drives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::test {

float loudest(const array::Drive& drive) {
  float most = 0;
  for (const array::TransducerDrive& transducer : drive)
    most = std::max(most, transducer.amplitude);
  return most;
}

DriveRecording read_to_silence(const std::filesystem::path& recording) {
  DriveRecording heard = read_drive_recording(recording);
  EXPECT_FALSE(heard.drives.empty()) << recording;
  const array::Drive last = heard.drives.empty() ? array::Drive() : heard.drives.back().drive;
  EXPECT_TRUE(std::ranges::all_of(last, [](const auto& t) { return t.amplitude == 0 && t.phase == 0; })) << recording;
  return heard;
}

array::Drive last_sound(const std::filesystem::path& recording) {
  const DriveRecording heard = read_to_silence(recording);
  const auto sounds = [](const RecordedDrive& d) { return loudest(d.drive) > 0; };
  const auto last = std::find_if(heard.drives.rbegin(), heard.drives.rend(), sounds);
  EXPECT_TRUE(last != heard.drives.rend()) << "it must sound";
  return last == heard.drives.rend() ? array::Drive() : last->drive;
}

double phases_off(const array::Drive& drive, const Transform& T_world_layout, const Vec3& focus) {
  const array::SlotFocus slot{focus};
  const array::Drive expected =
      array::drive_for(array::transformed(array::load_layout("openmpd"), T_world_layout), std::span(&slot, 1));
  if (drive.size() != expected.size()) return 1e9;
  double most = 0;
  for (std::size_t i = 0; i < drive.size(); ++i)
    most = std::max(most, std::abs(std::remainder(double{drive[i].phase} - expected[i].phase, 2 * std::numbers::pi)));
  return most;
}

}  // namespace palpa::test
