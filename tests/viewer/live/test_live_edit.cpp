// Options of a live run that change during the run: values and command line stay consistent.
#include "viewer/live/live_edit.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

const line::Given line{{"--scene", {"a.glb"}}, {"--gltf-scene", {"1"}}, {"--noise-free", {}},
                       {"--delta", {"2mm"}},   {"--dark", {}},          {"--json", {"of-the-viewer.json"}}};

TEST(LiveEdit, HasWhatARunHasOfTheLine) {
  const LiveEdit edit(line);
  EXPECT_EQ(edit.options().scene, "a.glb");
  EXPECT_EQ(edit.options().gltf_scene, 1u);
  EXPECT_EQ(edit.options().touch.parameters.delta_m, 2e-3);
  EXPECT_TRUE(edit.options().noise_free);
  EXPECT_TRUE(edit.options().watched);
  EXPECT_EQ(edit.command(), "palpa run --scene a.glb --gltf-scene 1 --noise-free --delta 2mm");
  EXPECT_ERROR(LiveEdit(line::Given{{"--delta", {"-1"}}}), Exit::usage, "--delta: '-1'");
}

TEST(LiveEdit, AnotherSceneTakesNothingOverFromTheOneBefore) {
  LiveEdit edit(line);
  edit.open_scene("a.glb");
  EXPECT_TRUE(edit.runs_as(LiveEdit(line))) << "it is the same file";
  edit.open_scene("b.glb");
  EXPECT_FALSE(edit.runs_as(LiveEdit(line)));
  EXPECT_EQ(edit.options().scene, "b.glb");
  EXPECT_FALSE(edit.options().gltf_scene);
  EXPECT_EQ(edit.command(), "palpa run --scene b.glb --noise-free --delta 2mm");
  edit = LiveEdit(line);
  edit.replace_scene("a.glb");
  EXPECT_FALSE(edit.options().gltf_scene) << "the file has other contents";
}

TEST(LiveEdit, ARecordingHasTheNoiseThatItHas) {
  LiveEdit edit(line);
  edit.play_recording("take");
  edit.check();
  EXPECT_EQ(edit.options().source, "recording:take");
  EXPECT_FALSE(edit.options().noise_free);
  EXPECT_EQ(edit.command(), "palpa run --scene a.glb --gltf-scene 1 --source recording:take --delta 2mm");
}

TEST(LiveEdit, ATouchLeavesItsSpectrumBehind) {
  LiveEdit edit(line::Given{{"--scene", {"a.glb"}}, {"--spot", {"4mm"}}, {"--spectrum", {}}});
  EXPECT_ERROR(edit.check(), Exit::usage, "--spot goes with");
  edit.leave_touch();
  edit.check();
  EXPECT_EQ(edit.command(), "palpa run --scene a.glb");
  LiveEdit tuned(line::Given{{"--scene", {"a.glb"}}, {"--spot", {"4mm"}}, {"--tune", {}}});
  tuned.leave_touch();
  EXPECT_EQ(tuned.options().touch.spot_m, 4e-3);
}

TEST(LiveEdit, FieldsSetOptionsAndTakeThemBack) {
  LiveEdit edit(line);
  EXPECT_EQ(edit.text("--delta"), "2mm");
  EXPECT_EQ(edit.text("--noise-free"), "") << "it is set";
  EXPECT_FALSE(edit.text("--hold"));
  edit.set("--hold", "0.2");
  EXPECT_EQ(edit.options().hold_s, 0.2);
  EXPECT_EQ(edit.text("--hold"), "0.2") << "as it was typed";
  edit.set("--hold", "auto");
  EXPECT_TRUE(edit.options().hold_auto);
  edit.set("--every-frame", "");
  EXPECT_TRUE(edit.options().every_frame);
  edit.set("--hold", std::nullopt);
  edit.set("--delta", std::nullopt);
  edit.set("--every-frame", std::nullopt);
  EXPECT_FALSE(edit.options().hold_auto || edit.options().every_frame);
  EXPECT_EQ(edit.options().hold_s, setup::LiveOptions().hold_s);
  EXPECT_EQ(edit.options().touch.parameters.delta_m, setup::LiveOptions().touch.parameters.delta_m);
  EXPECT_EQ(edit.command(), "palpa run --scene a.glb --gltf-scene 1 --noise-free");
}

TEST(LiveEdit, WhatCannotBeChangesNothing) {
  LiveEdit edit(line);
  EXPECT_ERROR(edit.set("--delta", "-1"), Exit::usage, "--delta: '-1'");
  EXPECT_ERROR(edit.set("--frames", "many"), Exit::usage, "--frames: 'many'");
  EXPECT_TRUE(edit.runs_as(LiveEdit(line)));
  EXPECT_EQ(edit.options().touch.parameters.delta_m, 2e-3);
}

TEST(LiveEdit, SaysWhatDoesNotGoTogether) {
  LiveEdit edit(line);
  edit.set("--source", "recording:take");
  EXPECT_ERROR(edit.check(), Exit::usage, "--noise-free");
  edit.set("--noise-free", std::nullopt);
  edit.check();
  edit.set("--scene", std::nullopt);
  EXPECT_ERROR(edit.check(), Exit::usage, "--scene is missing");
}

TEST(LiveEdit, OptionsOfTheCopiedCommandAreNoneOfTheRun) {
  LiveEdit edit(line);
  edit.set("--frames", "300");
  edit.set("--quiet", "");
  EXPECT_TRUE(edit.runs_as(LiveEdit(line)));
  EXPECT_EQ(edit.options().frames, 0u);
  EXPECT_EQ(edit.text("--frames"), "300");
  edit.open_scene("b.glb");
  EXPECT_EQ(edit.command(), "palpa run --scene b.glb --frames 300 --noise-free --delta 2mm --quiet");
}

/// Functions and fields agree: the values are those of the command line.
TEST(LiveEdit, ValuesAreThoseOfTheLine) {
  LiveEdit edit(line), typed(line);
  edit.play_recording("take");
  edit.open_scene("b.glb");
  typed.set("--noise-free", std::nullopt);
  typed.set("--source", "recording:take");
  typed.set("--scene", "b.glb");
  typed.set("--gltf-scene", std::nullopt);
  EXPECT_TRUE(edit.runs_as(typed));
  EXPECT_EQ(edit.options().source, typed.options().source);
  EXPECT_EQ(edit.options().scene, typed.options().scene);
  EXPECT_EQ(edit.options().gltf_scene, typed.options().gltf_scene);
  EXPECT_EQ(edit.options().noise_free, typed.options().noise_free);
}

}  // namespace
}  // namespace palpa::viewer
