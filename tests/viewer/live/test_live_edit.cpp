// Options of a live run that change during the run, and the line of `palpa run` that they stand for: both stay
// consistent.
#include "viewer/live/live_edit.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "support/thrown.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

const line::Given line{{"--scene", {"a.glb"}}, {"--gltf-scene", {"1"}}, {"--noise-free", {}},
                       {"--delta", {"2mm"}},   {"--dark", {}},          {"--json", {"of-the-viewer.json"}}};

/// The values are those of the command line.
void expect_of_its_line(const LiveEdit& edit) {
  const setup::LiveOptions &is = edit.options(), of_line = values_of(edit.line());
  EXPECT_EQ(is.scene, of_line.scene);
  EXPECT_EQ(is.gltf_scene, of_line.gltf_scene);
  EXPECT_EQ(is.source, of_line.source);
  EXPECT_EQ(is.noise_free, of_line.noise_free);
  EXPECT_EQ(is.every_frame, of_line.every_frame);
  EXPECT_EQ(is.hold_s, of_line.hold_s);
  EXPECT_EQ(is.hold_auto, of_line.hold_auto);
  EXPECT_EQ(is.frames, of_line.frames);
  EXPECT_EQ(is.touch.parameters.delta_m, of_line.touch.parameters.delta_m);
  EXPECT_EQ(is.touch.spot_m, of_line.touch.spot_m);
}

TEST(LiveEdit, EveryChangeChangesValuesAndCommand) {
  struct Case {
    std::string what;
    line::Given line;
    std::function<void(LiveEdit&)> change;
    std::string command;  ///< after "palpa run --scene "
    bool same = false;    ///< the run is the same
  };
  const line::Given touch{{"--scene", {"a.glb"}}, {"--spot", {"4mm"}}, {"--spectrum", {}}};
  const line::Given tuned{{"--scene", {"a.glb"}}, {"--spot", {"4mm"}}, {"--tune", {}}};
  const std::string before = "a.glb --gltf-scene 1 --noise-free --delta 2mm";
  const auto set = [](const std::string& option, const std::optional<std::string>& text) {
    return [=](LiveEdit& edit) { edit.set(option, text); };
  };
  for (const Case& one : std::vector<Case>{
           {"nothing", line, [](LiveEdit&) {}, before, true},
           {"the same file", line, [](LiveEdit& edit) { edit.open_scene("a.glb"); }, before, true},
           {"another scene takes nothing over", line, [](LiveEdit& edit) { edit.open_scene("b.glb"); },
            "b.glb --noise-free --delta 2mm"},
           {"the file has other contents", line, [](LiveEdit& edit) { edit.replace_scene("a.glb"); },
            "a.glb --noise-free --delta 2mm"},
           {"a recording has the noise that it has", line, [](LiveEdit& edit) { edit.play_recording("take"); },
            "a.glb --gltf-scene 1 --source recording:take --delta 2mm"},
           {"a touch leaves its spectrum behind", touch, [](LiveEdit& edit) { edit.leave_touch(); }, "a.glb"},
           {"but not what tuning needs", tuned, [](LiveEdit& edit) { edit.leave_touch(); }, "a.glb --tune --spot 4mm",
            true},
           {"a number", line, set("--hold", "0.2"), "a.glb --gltf-scene 1 --hold 0.2 --noise-free --delta 2mm"},
           {"a word", line, set("--hold", "auto"), "a.glb --gltf-scene 1 --hold auto --noise-free --delta 2mm"},
           {"a flag", line, set("--every-frame", ""), "a.glb --gltf-scene 1 --noise-free --every-frame --delta 2mm"},
           {"a default", line, set("--delta", std::nullopt), "a.glb --gltf-scene 1 --noise-free"},
           {"a flag is taken back", line, set("--noise-free", std::nullopt), "a.glb --gltf-scene 1 --delta 2mm"},
           {"no option of the run", line, set("--frames", "300"),
            "a.glb --gltf-scene 1 --frames 300 --noise-free --delta 2mm", true},
           {"a flag of the command", line, set("--quiet", ""), before + " --quiet", true},
           {"a word of the command", line, set("--stats", "json"),
            "a.glb --gltf-scene 1 --noise-free --stats json --delta 2mm", true},
           {"a finger that the pointer moves is the viewer's own", line, set("--source", "mouse"),
            "a.glb --gltf-scene 1 --source synthetic --noise-free --delta 2mm"},
           {"and so with a mesh", line, set("--source", "mouse:thumb.ply"),
            "a.glb --gltf-scene 1 --source synthetic:thumb.ply --noise-free --delta 2mm"},
           {"a source whose name begins alike", line, set("--source", "mouses:thumb.ply"),
            "a.glb --gltf-scene 1 --source mouses:thumb.ply --noise-free --delta 2mm"},
           {"a name with a space", {{"--scene", {"a b.glb"}}}, set("--every-frame", ""), "'a b.glb' --every-frame"},
       }) {
    SCOPED_TRACE(one.what);
    LiveEdit edit(one.line);
    one.change(edit);
    EXPECT_EQ(edit.runs_as(LiveEdit(one.line)), one.same);
    EXPECT_EQ(edit.command(), "palpa run --scene " + one.command);
    expect_of_its_line(edit);
    EXPECT_TRUE(edit.options().watched);
  }
}

TEST(LiveEdit, FieldsShowWhatWasTyped) {
  LiveEdit edit(line);
  edit.set("--hold", "0.2");
  edit.set("--frames", "300");
  EXPECT_EQ(edit.text("--hold"), "0.2");
  EXPECT_EQ(edit.text("--frames"), "300");
  EXPECT_EQ(edit.text("--delta"), "2mm");
  EXPECT_EQ(edit.text("--noise-free"), "") << "it is set";
  EXPECT_FALSE(edit.text("--every-frame"));
}

TEST(LiveEdit, WhatIsNoValueChangesNothing) {
  LiveEdit edit(line);
  EXPECT_ERROR(edit.set("--delta", "-1"), Exit::usage, "--delta: '-1'");
  EXPECT_ERROR(edit.set("--frames", "many"), Exit::usage, "--frames: 'many'");
  EXPECT_TRUE(edit.runs_as(LiveEdit(line)));
  EXPECT_EQ(edit.command(), LiveEdit(line).command());
  expect_of_its_line(edit);
  EXPECT_ERROR(LiveEdit(line::Given{{"--delta", {"-1"}}}), Exit::usage, "--delta: '-1'");
}

TEST(LiveEdit, SaysWhatDoesNotGoTogether) {
  LiveEdit edit(line);
  edit.set("--source", "recording:take");
  EXPECT_ERROR(edit.check(), Exit::usage, "--noise-free");
  edit.play_recording("take");
  edit.check();
  edit.set("--scene", std::nullopt);
  EXPECT_ERROR(edit.check(), Exit::usage, "--scene is missing");
  LiveEdit touch(line::Given{{"--scene", {"a.glb"}}, {"--spot", {"4mm"}}, {"--spectrum", {}}});
  EXPECT_ERROR(touch.check(), Exit::usage, "--spot goes with");
  touch.leave_touch();
  touch.check();
}

TEST(LiveLine, TheTableHasWordsAndDefaults) {
  bool method = false, delta = false;
  for (const line::OptionInfo& info : live_table()) {
    if (info.name == "--method") method = info.words.size() == 4 && info.initial == "cross-section";
    if (info.name == "--delta")
      delta = info.initial == "1.5mm" && info.type == "LENGTH" && info.help.ends_with("may be");
    EXPECT_EQ(info.type == "WORD", info.words.size() > 1) << info.name;
  }
  EXPECT_TRUE(method && delta);
}

}  // namespace
}  // namespace palpa::viewer
