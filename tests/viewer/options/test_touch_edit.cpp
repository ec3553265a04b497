// Options of a single touch that change while it is shown: values and command line stay consistent.
#include "viewer/options/touch_edit.hpp"

#include <gtest/gtest.h>

#include "support/thrown.hpp"

namespace palpa::viewer {
namespace {

const line::Given line{{"--scene", {"a.glb"}},  {"--gltf-scene", {"1"}}, {"--depth", {"frame.toml"}},
                       {"--layout", {"paper"}}, {"--slice", {"yz"}},     {"--foci", {"7"}},
                       {"--backend", {"cpu"}},  {"--no-panels", {}}};

/// The values are those of the command line.
const ViewerOptions& consistent(const TouchEdit& edit) {
  const ViewerOptions &is = edit.options(), of_line = options_of(is.given);
  EXPECT_EQ(is.input.scene, of_line.input.scene);
  EXPECT_EQ(is.input.gltf_scene, of_line.input.gltf_scene);
  EXPECT_EQ(is.input.points, of_line.input.points);
  EXPECT_EQ(is.input.depths, of_line.input.depths);
  EXPECT_EQ(is.touch.parameters.foci, of_line.touch.parameters.foci);
  EXPECT_EQ(is.slice.plane, of_line.slice.plane);
  EXPECT_EQ(is.layout, of_line.layout);
  return is;
}

TEST(TouchEdit, AnotherSceneTakesNothingOverFromTheOneBefore) {
  TouchEdit edit(options_of(line));
  edit.open_scene("a.glb");
  EXPECT_EQ(consistent(edit).given, line) << "it is the same file";
  edit.open_scene("b.glb");
  EXPECT_EQ(consistent(edit).input.scene, "b.glb");
  EXPECT_FALSE(edit.options().input.gltf_scene);
  EXPECT_FALSE(edit.options().given.contains("--gltf-scene"));
}

TEST(TouchEdit, PointsReplaceDepthImages) {
  TouchEdit edit(options_of(line));
  for (const char* file : {"hand.ply", "finger.ply"}) {
    edit.use_points(file);
    EXPECT_EQ(consistent(edit).input.points, file);
    EXPECT_TRUE(edit.options().input.depths.empty());
    edit.check();
  }
}

TEST(TouchEdit, FieldsSetOptionsThatGoTogetherAndTakeThemBack) {
  TouchEdit edit(options_of(line));
  edit.set("--foci", "5");
  EXPECT_EQ(consistent(edit).touch.parameters.foci, 5u);
  edit.set("--allow-outside", "");
  EXPECT_TRUE(consistent(edit).given.at("--allow-outside").empty()) << "a flag";
  edit.set("--foci", std::nullopt);
  EXPECT_EQ(consistent(edit).touch.parameters.foci, ViewerOptions().touch.parameters.foci);
  EXPECT_ERROR(edit.set("--foci", "many"), Exit::usage, "--foci: 'many'");
  EXPECT_FALSE(consistent(edit).given.contains("--foci")) << "it changes nothing";
  edit.check();
  edit.set("--points", "hand.ply");
  EXPECT_ERROR(edit.check(), Exit::usage, "--points");
}

}  // namespace
}  // namespace palpa::viewer
