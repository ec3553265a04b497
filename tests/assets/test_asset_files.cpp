// The files in assets/ are what the generators write, byte for byte.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/recording.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa {
namespace {

int run(const char* program, const std::string& arguments) {
  const int status = std::system(fmt::format("'{}' {} 2> /dev/null", program, arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// `below`: the folder of the committed file in assets/.
void expect_as_committed(const std::filesystem::path& folder, const std::string& name, const std::string& below = "") {
  const std::string committed = test::read_text(test::source_file("assets/" + below + name));
  ASSERT_FALSE(committed.empty()) << name;
  EXPECT_TRUE(test::read_text(folder / name) == committed)
      << name << " differs: build assets_regenerate and commit, or mend";
}

TEST(AssetFiles, Objects) {
  const auto folder = test::scratch_folder("assets-objects");
  ASSERT_EQ(run(MAKE_OBJECTS, "'" + folder.string() + "'"), 0);
  for (const std::string name : {"cube", "semi-sphere", "pyramid", "prism"}) {
    expect_as_committed(folder, name + ".glb");
    const auto scene = geometry::load_gltf(folder / (name + ".glb"));
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(scene.meshes[0].name, name);
  }
  expect_as_committed(folder, "button-and-knob.glb");
  const auto controls = geometry::load_gltf(folder / "button-and-knob.glb").meshes;
  ASSERT_EQ(controls.size(), 2U);
  EXPECT_EQ(controls[0].name, "button");
  EXPECT_EQ(controls[0].haptics.press_depth_m, 0.003);
  EXPECT_EQ(controls[0].haptics.click, geometry::Click());
  EXPECT_EQ(controls[1].name, "knob");
  EXPECT_EQ(controls[1].haptics.foci, 8U);
  EXPECT_EQ(controls[1].haptics.intensity, 0.7);
  expect_as_committed(folder, "design.glb");
  const auto design = geometry::load_gltf(folder / "design.glb").meshes;
  ASSERT_EQ(design.size(), 4U);
  EXPECT_TRUE(design[0].haptics.clicks());
  EXPECT_EQ(design[1].haptics.stiffness->size(), 2U);
  EXPECT_EQ(design[2].haptics.grain_m, 0.002);
  EXPECT_EQ(design[3].haptics.texture, (std::array<double, 3>{1, 0, 0.15}));
}

TEST(AssetFiles, Finger) {
  const auto folder = test::scratch_folder("assets-finger");
  ASSERT_EQ(run(MAKE_FINGER, "'" + folder.string() + "'"), 0);
  expect_as_committed(folder, "finger.glb");
  expect_as_committed(folder, "finger.ply");
  const auto scene = geometry::load_gltf(folder / "finger.glb");
  const auto ply = geometry::read_ply(folder / "finger.ply");
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].name, "finger");
  EXPECT_TRUE(scene.meshes[0].mesh.positions == ply.positions);
  EXPECT_TRUE(scene.meshes[0].mesh.triangles == ply.triangles);
}

TEST(AssetFiles, Hands) {
  const auto folder = test::scratch_folder("assets-hand");
  const std::pair<const char*, const char*> hands[] = {
      {"spread", "hand.glb"}, {"point", "hand-point.glb"}, {"relaxed", "hand-relaxed.glb"}};
  for (const auto& [pose, name] : hands) {
    ASSERT_EQ(run(MAKE_HAND, std::string("--pose ") + pose + " -o '" + (folder / name).string() + "'"), 0);
    expect_as_committed(folder, name);
    EXPECT_LT(std::filesystem::file_size(folder / name), 1000000U);
  }
  EXPECT_EQ(geometry::load_gltf(folder / "hand.glb").meshes.at(0).name, "hand");
}

/// Images are compared by their pixels, because versions of zlib may pack them differently. A C library may round a
/// sine differently, so a few pixels of an edge may differ.
void expect_same_image(const std::filesystem::path& made, const std::filesystem::path& committed) {
  constexpr std::uint32_t width = 424, height = 240;
  std::vector<std::uint16_t> a, b;
  sensing::read_png16(made, width, height, a);
  sensing::read_png16(committed, width, height, b);
  std::size_t different = 0, skin = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    different += a[i] != b[i];
    skin += b[i] != 0;
  }
  EXPECT_LE(different, 20U) << committed << " differs: build assets_regenerate and commit, or mend";
  EXPECT_GT(skin, 5000U) << committed;
}

TEST(AssetFiles, DepthImages) {
  const auto folder = test::scratch_folder("assets-depth");
  ASSERT_EQ(run(MAKE_DEPTH, "'" + folder.string() + "'"), 0);
  expect_as_committed(folder, "camera.toml", "depth/");
  expect_as_committed(folder / "take", "recording.toml", "depth/take/");
  expect_as_committed(folder / "take", "times.csv", "depth/take/");
  expect_same_image(folder / "hand.png", test::source_file("assets/depth/hand.png"));
  const sensing::Recording take = sensing::load_recording(test::source_file("assets/depth/take"));
  EXPECT_EQ(take.entries.size(), 12U);
  for (const sensing::Recording::Entry& entry : take.entries)
    expect_same_image(folder / "take" / entry.files.at(0).filename(), entry.files.at(0));
  EXPECT_EQ(run(MAKE_DEPTH, "'" + folder.string() + "'"), 0) << "the recording is replaced";
}

TEST(AssetFiles, GeneratorsSayWhatIsWrong) {
  EXPECT_EQ(run(MAKE_OBJECTS, ""), 2);
  EXPECT_EQ(run(MAKE_OBJECTS, "/nowhere/at/all"), 1);
  EXPECT_EQ(run(MAKE_HAND, "--pose spread"), 2);
  EXPECT_EQ(run(MAKE_HAND, "--pose wave -o /dev/null"), 2);
  EXPECT_EQ(run(MAKE_HAND, "--pose point -o /dev/full"), 1);
}

}  // namespace
}  // namespace palpa
