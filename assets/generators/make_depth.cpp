// make_depth FOLDER: writes what a depth camera sees of the pointing hand at the paper's objects: hand.png, one image
// of the fingertip 3 mm below their top, with camera.toml; and take/, a recording in which it dips in and comes out
// again.
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "assets/generators/hand.hpp"
#include "assets/generators/program.hpp"
#include "base/files/output_file.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/recording.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"

namespace palpa::assets {
namespace {

/// It stands below and in front of the fingertip, 0.25 m away, and looks up at it. A pixel is 0.6 mm wide there.
sensing::Camera make_camera() {
  const Vec3 eye(0, -0.15, 0.2), target(0, 0.03, 0);
  const Vec3 forward = glm::normalize(target - eye), right(1, 0, 0), down = glm::cross(forward, right);
  sensing::Camera camera;
  camera.name = "example";
  camera.width = 424;
  camera.height = 240;
  camera.fx = camera.fy = 400;
  camera.cx = 211.5;
  camera.cy = 119.5;
  camera.depth_unit_m = 1e-4;
  camera.rate_hz = 30;
  camera.T_world_camera = Transform(1.0);
  const std::array<Vec3, 4> columns{right, down, forward, eye};
  for (int column = 0; column < 4; ++column) {
    // Rounded to the digits of a hand-written rig.
    for (int row = 0; row < 3; ++row)
      camera.T_world_camera[column][row] = std::round(columns[static_cast<std::size_t>(column)][row] * 1e9) / 1e9;
  }
  return camera;
}

/// Metres above the objects' top: from 2 mm above to 4 mm below, and back.
double height_at(std::uint64_t frame, std::uint64_t frames) {
  const double part = static_cast<double>(frame) / static_cast<double>(frames - 1);
  return 2e-3 - 6e-3 * std::sin(std::numbers::pi * part);
}

void write_all(const std::filesystem::path& folder) {
  constexpr std::uint64_t frames = 12;
  const sensing::Camera camera = make_camera();
  const geometry::Mesh hand = make_hand(*named_hand_pose("point"));
  sensing::SyntheticRig rig({camera}, {}, sensing::Noise::none, 1);
  sensing::FrameSet set;
  const auto look = [&](double height_m, std::uint64_t frame) {
    const sensing::Posed posed{&hand, glm::translate(Transform(1.0), Vec3(0, height_m, 0)), "the hand"};
    rig.render({&posed, 1}, frame, set);
    set.sequence = frame;
    set.time_s = set.frames[0].time_s = static_cast<double>(frame) / camera.rate_hz;
  };

  look(-3e-3, 0);
  sensing::write_png16(folder / "hand.png", camera.width, camera.height, set.frames[0].depth);
  write_file(folder / "camera.toml",
             "# The camera of hand.png. The world is that of the paper's objects: +y up, their top at y = 0.\n\n" +
                 sensing::to_toml(sensing::Rig{"", {camera}, {}, {}}));
  sensing::RecordingWriter take(folder / "take", {camera}, sensing::Existing::replaced);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    look(height_at(frame, frames), frame);
    take.write(set);
  }
}

}  // namespace
}  // namespace palpa::assets

int main(int argc, char** argv) {
  return palpa::assets::run_program(
      [&] { palpa::assets::write_all(palpa::assets::only_argument(argc, argv, "FOLDER")); });
}
