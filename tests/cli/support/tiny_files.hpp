// The smallest scene and recording that palpa reads, from files next to each other.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sensing/grey_png.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

/// 72 bytes: a tetrahedron's corners and faces.
inline void write_tetrahedron(const std::filesystem::path& bin) {
  const std::array<float, 12> corners{0, 0, 0, .1f, 0, 0, 0, .1f, 0, 0, 0, .1f};
  const std::array<std::uint16_t, 12> faces{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  write_text(bin, std::string(reinterpret_cast<const char*>(corners.data()), sizeof(corners)) +
                      std::string(reinterpret_cast<const char*>(faces.data()), sizeof(faces)));
}

/// A scene with such a tetrahedron, which is in `uri`, and a picture that nothing uses.
inline void write_scene(const std::filesystem::path& gltf, const std::string& uri,
                        const std::string& picture = "picture.png") {
  write_text(gltf, R"({"asset":{"version":"2.0"},"images":[{"uri":")" + picture + R"("}],
    "buffers":[{"uri":")" +
                       uri + R"(","byteLength":72}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[0.1,0.1,0.1]},
                 {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}]})");
}

inline constexpr const char* tiny_camera =
    "[[camera]]\nwidth = 8\nheight = 4\nfx = 5\nfy = 5\ncx = 2\ncy = 1\nrate_hz = 30\n";

/// A camera's image of one depth.
inline void write_depth(const std::filesystem::path& png) {
  sensing::write_png16(png, 8, 4, std::vector<std::uint16_t>(32, 300));
}

/// A recording of one frame; `keys` is text in its [recording], `mask` at its camera.
inline void write_recording(const std::filesystem::path& toml, const std::string& keys, const std::string& mask = {}) {
  write_text(toml,
             std::string(tiny_camera) + (mask.empty() ? "" : "mask = \"" + mask + "\"\n") + "[recording]\n" + keys);
}

/// A scene, a finger, a layout, a rig, a camera with its depth image, and a recording, with all files that these name.
inline void write_tiny_files(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "take");
  write_tetrahedron(folder / "corners.bin");
  write_scene(folder / "scene.gltf", "c%6Frners.bin");
  write_text(folder / "picture.png", "that nobody looks at");
  std::filesystem::copy_file(source_file("assets/finger.ply"), folder / "finger.ply");
  write_text(folder / "layout.toml", "[[transducer]]\nposition_m = [0, 0, -0.1]\naxis = [0, 0, 1]\n");
  sensing::write_png8(folder / "mask.png", 8, 4, std::vector<std::uint8_t>(32, 1));
  write_text(folder / "rig.toml",
             std::string(tiny_camera) + "mask = \"mask.png\"\n[array]\nlayout = \"layout.toml\"\n");
  write_text(folder / "camera.toml", tiny_camera);
  write_depth(folder / "depth.png");
  write_depth(folder / "take/depth-0.png");
  sensing::write_png8(folder / "take/mask.png", 8, 4, std::vector<std::uint8_t>(32, 1));
  write_text(folder / "take/times.csv", "sequence,time_0_s\n0,0.5\n");
  write_recording(folder / "take/recording.toml", "files = [\"depth-%d.png\"]\ntimes = \"times.csv\"\n", "mask.png");
}

}  // namespace palpa::test
