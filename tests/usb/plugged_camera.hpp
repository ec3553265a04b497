// An emulated depth camera on the kernel's USB, and the pictures that it gives.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "usb/plugged_board.hpp"
#include "usb/vhci_port.hpp"
#include "usb/z16_camera.hpp"

namespace palpa::test {

class PluggedCamera {
 public:
  explicit PluggedCamera(const std::string& serial) : gadget(serial), port(gadget) { plug(); }

  /// Returns when the kernel has created its nodes.
  void plug() {
    port.plug();
    EXPECT_TRUE(eventually(5, [&] { return !node().empty(); }));
  }
  /// "/dev/videoN", the node of its frames; empty if there is none.
  std::string node() const {
    std::error_code none;
    const auto nodes = std::filesystem::path("/sys/bus/usb/devices") / (port.place() + ":1.0") / "video4linux";
    for (const auto& entry : std::filesystem::directory_iterator(nodes, none)) {
      const std::string name = "/dev/" + entry.path().filename().string();
      if (read_text(entry.path() / "index") == "0\n" && std::filesystem::exists(name)) return name;
    }
    return {};
  }
  void show(Z16Camera::Picture picture) {
    const auto held = port.hold();
    gadget.show(std::move(picture));
  }

  Z16Camera gadget;
  VhciPort port;
};

/// The first cameras of the paper's rig, at that rate, without an array.
inline sensing::Rig rig_of(std::size_t cameras, double rate_hz) {
  sensing::Rig rig = sensing::load_rig(source_file("assets/rigs/paper.toml"));
  rig.cameras.resize(cameras);
  for (sensing::Camera& camera : rig.cameras)
    camera.rate_hz = rate_hz;
  rig.array.reset();
  return rig;
}

/// Its file.
inline std::string written(const sensing::Rig& rig) {
  const auto file = scratch_folder("rig") / "rig.toml";
  write_text(file, to_toml(rig));
  return file.string();
}

/// For each of its cameras, the picture of a fingertip 2 mm inside an object with its top at y = 0.
inline std::vector<Z16Camera::Picture> touching(const sensing::Rig& rig) {
  geometry::Mesh finger;
  for (const geometry::SceneMesh& part : geometry::load_gltf(source_file("assets/finger.glb")).meshes)
    geometry::append(finger, part.mesh);
  Transform pose(1.0);
  pose[3][1] = -2e-3;
  sensing::SyntheticRig synthetic(rig.cameras, {}, sensing::Noise::none, 1);
  sensing::FrameSet set;
  const sensing::Posed skin[] = {{&finger, pose}};
  synthetic.render(skin, 0, set);
  std::vector<Z16Camera::Picture> pictures;
  for (const sensing::DepthFrame& frame : set.frames)
    pictures.push_back(frame.depth);
  return pictures;
}

}  // namespace palpa::test
