#include "cli/support/heard_drives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "array/layouts/layout.hpp"
#include "session/links/record_link.hpp"

namespace palpa::test {

array::Drive last_sound(const std::filesystem::path& recording) {
  const session::DriveRecording heard = session::read_drive_recording(recording);
  const auto sounds = [](const session::RecordedDrive& d) {
    return std::ranges::any_of(d.drive, [](const auto& t) { return t.amplitude > 0; });
  };
  const auto last = std::find_if(heard.drives.rbegin(), heard.drives.rend(), sounds);
  EXPECT_TRUE(last != heard.drives.rend() && last != heard.drives.rbegin()) << "it must sound and end in silence";
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
