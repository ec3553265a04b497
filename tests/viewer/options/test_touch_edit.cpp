// Options of a single touch that change while it is shown: values and command line stay consistent.
#include "viewer/options/touch_edit.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "support/thrown.hpp"

namespace palpa::viewer {
namespace {

const line::Given line{{"--scene", {"a.glb"}},  {"--gltf-scene", {"1"}}, {"--depth", {"frame.toml"}},
                       {"--layout", {"paper"}}, {"--slice", {"yz"}},     {"--foci", {"7"}},
                       {"--backend", {"cpu"}},  {"--no-panels", {}}};

/// The values are those of the command line.
void expect_of_its_line(const TouchEdit& edit) {
  const ViewerOptions &is = edit.options(), line = options_of(is.given);
  EXPECT_EQ(is.input.scene, line.input.scene);
  EXPECT_EQ(is.input.gltf_scene, line.input.gltf_scene);
  EXPECT_EQ(is.input.points, line.input.points);
  EXPECT_EQ(is.input.depths, line.input.depths);
  EXPECT_EQ(is.touch.parameters.foci, line.touch.parameters.foci);
  EXPECT_EQ(is.slice.plane, line.slice.plane);
  EXPECT_EQ(is.layout, line.layout);
}

TEST(TouchEdit, AnotherSceneTakesNothingOverFromTheOneBefore) {
  TouchEdit edit(options_of(line));
  edit.open_scene("a.glb");
  EXPECT_EQ(edit.options().given, line) << "it is the same file";
  expect_of_its_line(edit);
  edit.open_scene("b.glb");
  EXPECT_EQ(edit.options().input.scene, "b.glb");
  EXPECT_FALSE(edit.options().input.gltf_scene);
  EXPECT_FALSE(edit.options().given.contains("--gltf-scene"));
  expect_of_its_line(edit);
}

TEST(TouchEdit, PointsReplaceDepthImages) {
  TouchEdit edit(options_of(line));
  edit.use_points("hand.ply");
  EXPECT_EQ(edit.options().input.points, "hand.ply");
  EXPECT_TRUE(edit.options().input.depths.empty());
  expect_of_its_line(edit);
  edit.check();
  edit.use_points("finger.ply");
  EXPECT_EQ(edit.options().input.points, "finger.ply");
  expect_of_its_line(edit);
}

TEST(TouchEdit, FieldsSetOptionsAndTakeThemBack) {
  TouchEdit edit(options_of(line));
  edit.set("--foci", "5");
  EXPECT_EQ(edit.options().touch.parameters.foci, 5u);
  edit.set("--allow-outside", "");
  EXPECT_TRUE(edit.options().given.at("--allow-outside").empty()) << "a flag";
  expect_of_its_line(edit);
  edit.set("--foci", std::nullopt);
  EXPECT_EQ(edit.options().touch.parameters.foci, ViewerOptions().touch.parameters.foci);
  expect_of_its_line(edit);
  EXPECT_ERROR(edit.set("--foci", "many"), Exit::usage, "--foci: 'many'");
  expect_of_its_line(edit);
  EXPECT_FALSE(edit.options().given.contains("--foci")) << "it changes nothing";
}

TEST(TouchEdit, SaysWhatDoesNotGoTogether) {
  TouchEdit edit(options_of(line));
  edit.check();
  edit.set("--points", "hand.ply");
  EXPECT_ERROR(edit.check(), Exit::usage, "--points");
}

}  // namespace
}  // namespace palpa::viewer
