// The physical set-up as a TOML file: cameras, array and screen with their poses in the world (docs/cameras.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sensing/camera.hpp"

namespace palpa::sensing {

struct ArrayPlacement {
  std::string layout;                       ///< a built-in layout's name or the path of a layout TOML
  std::optional<Transform> T_world_layout;  ///< absent: the layout's default pose
  std::string where;                        ///< "FILE: line N" of the layout's name, for messages
};

struct Screen {
  double width_m = 0, height_m = 0;
  Transform T_world_screen{1.0};
  Vec3 eye_m{};  ///< the viewer's eye in the world
  bool operator==(const Screen&) const = default;
};

/// The part of the world in which there may be skin.
struct Room {
  Box box;            ///< world, metres
  std::string where;  ///< "FILE: line N" of the table, for messages
};

struct Rig {
  std::string file;
  std::vector<Camera> cameras;
  std::optional<ArrayPlacement> array;
  std::optional<Screen> screen;
  std::optional<Room> room;
  std::optional<Transform> T_world_joints;  ///< of a tracker of hands
  std::optional<double> joints_residual_m;  ///< rms distance that remained when it was registered
};

/// Throws bad_input naming file, line and key: unknown keys, missing or non-finite values, sizes of zero or above
/// 16384, more pixels of all cameras than make_rays() accepts, distortion that cannot be undone somewhere in the image,
/// negative focal lengths, units or ranges, poses that are not rigid (4 rows of 4, last row 0 0 0 1, rotation
/// orthonormal to 1e-4), a `roi` that is not inside the image, a `mask` that read_png8 rejects or that leaves no pixel,
/// a `background` that is not a 16-bit image of this camera, a room without an inside.
Rig load_rig(const std::filesystem::path& file);
/// Throws as load_rig does, for a camera that comes from no file; `name` stands in place of the file.
void check_camera(const Camera& camera, const std::string& name);
/// The text that load_rig reads; doubles round-trip. Masks and backgrounds are named, not written.
std::string to_toml(const Rig& rig);

}  // namespace palpa::sensing
