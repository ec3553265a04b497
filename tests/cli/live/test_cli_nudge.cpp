// `palpa calibrate --nudge`: keys move a focus, which gives the array's pose.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "cli/keys.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/record_still.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "setup/tasks/register_cameras.hpp"
#include "support/files.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using cli::Key;
using cli::KeyPress;
using nlohmann::json;

TEST(Keys, AreReadFromATerminalsBytes) {
  std::vector<KeyPress> keys;
  cli::KeyReader reader;
  // Arrows in both of a terminal's modes, one of them in two pieces; shift; keys without a meaning; an unknown escape.
  reader.feed("\x1b[A\x1bOB\x1b", keys);
  reader.feed("[C\x1b[D\x1b[1;2A\x1b[5~\x1b[6~\x1b[6;2~x\x1b[3~\x1b\x1b[C\x1bqf0\rq", keys);
  const std::vector<KeyPress> expected{{Key::up},   {Key::down},   {Key::right},        {Key::left},  {Key::up, true},
                                       {Key::away}, {Key::nearer}, {Key::nearer, true}, {Key::right}, {Key::finer},
                                       {Key::back}, {Key::save},   {Key::leave}};
  EXPECT_EQ(keys, expected);
}

TEST(Keys, AreReadFromAScript) {
  const std::vector<KeyPress> expected{{Key::right},  {Key::right}, {Key::up, true},
                                       {Key::nearer}, {Key::wait},  {Key::save}};
  EXPECT_EQ(cli::parse_keys("--keys", " right*2, shift+up pagedown,wait enter"), expected);
  for (const char* bad : {"rigth", "right*", "right*0", "right*-1", "shift+enter", "*2", "right*2x"})
    EXPECT_ERROR(cli::parse_keys("--keys", bad), Exit::usage, "key '" + std::string(bad) + "'");
  EXPECT_ERROR(cli::parse_keys("--keys", "right*1000000"), Exit::usage, "--keys: more than");
}

/// A fingertip that rests 3 mm in the cube, before the paper's cameras, and an OpenMPD board that does not stand where
/// it usually does.
class Nudge : public testing::Test {
 protected:
  Nudge() {
    const std::filesystem::path assets = where_assets_are().second;
    rig_ = sensing::load_rig(assets / "rigs/paper.toml");
    rig_.array = sensing::ArrayPlacement{"openmpd", array::load_layout("openmpd").default_T_world_layout, {}};
    (*rig_.array->T_world_layout)[3] = Vec4(0.004, -0.145, 0.003, 1);
    write_text(file("rig.toml"), sensing::to_toml(rig_));
  }
  /// The folder of the recordings, which are made once: a resting fingertip, and two frames that are far apart in time.
  static const std::filesystem::path& takes() {
    static const std::filesystem::path made = [] {
      const std::filesystem::path folder = scratch_folder("nudge-takes"), assets = where_assets_are().second;
      const sensing::Rig rig = sensing::load_rig(assets / "rigs/paper.toml");
      const geometry::Ply finger = geometry::read_ply(assets / "finger.ply");
      const geometry::Mesh mesh{finger.positions, finger.triangles};
      const sensing::Posed posed{&mesh, glm::translate(Transform(1.0), Vec3(0, -0.003, 0))};
      sensing::SyntheticRig synthetic(rig.cameras, {}, sensing::Noise::none, 1);
      std::vector<double> times_s;
      for (int i = 0; i < 24; ++i)
        times_s.push_back(i / 90.0);
      record_still(folder / "still", rig.cameras, synthetic, std::span(&posed, 1), times_s);
      record_still(folder / "stuck", rig.cameras, synthetic, std::span(&posed, 1), {0, 1000});
      return folder;
    }();
    return made;
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  static std::string recording(const char* take) { return "recording:" + (takes() / take).string(); }
  std::vector<std::string> nudge(const std::string& keys) const {
    return {"calibrate",        "--nudge", "--backend",         "cpu",    "--rig", file("rig.toml"), "--source",
            recording("still"), "--out",   file("nudged.toml"), "--keys", keys};
  }
  std::filesystem::path folder_ = scratch_folder("nudge");
  sensing::Rig rig_;
};

TEST_F(Nudge, TheFocusMovesByWhatTheKeysSayAndARunWithTheNewRigPutsItThere) {
  succeeded(palpa_here(with(nudge("right*3 shift+up pageup f pageup*2 down left wait*8 enter"),
                            {"--link", "record:" + file("nudge.bin"), "--json", file("nudge.json"), "--hold", "10s"})));
  const Vec3 offset(0.0029, 0.0, -0.0012);
  const json said = json::parse(read_text(file("nudge.json")));
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(said["offset_m"][static_cast<std::size_t>(i)].get<double>(), offset[i], 1e-12);
  EXPECT_EQ(said["saved"], true);

  // Where the fingertip is seen.
  const std::vector<std::string> same{"--backend", "cpu",          "--scene",  where_assets_are().second + "/cube.glb",
                                      "--method",  "single-focus", "--source", recording("still")};
  succeeded(palpa_here(with({"export", "--foci", file("foci.json")}, same)));
  const json frames = json::parse(read_text(file("foci.json")))["frames"];
  const auto touching = [](const json& frame) { return !frame["fingers"].empty(); };
  const auto last = std::find_if(frames.rbegin(), frames.rend(), touching);
  ASSERT_TRUE(last != frames.rend());
  const json at = (*last)["fingers"][0]["foci_m"][0];
  const Vec3 seen(at[0], at[1], at[2]);
  const Transform T_world_layout = *rig_.array->T_world_layout;
  EXPECT_LT(phases_off(last_sound(file("nudge.bin")), T_world_layout, seen + offset), 2e-3);
  EXPECT_GT(phases_off(last_sound(file("nudge.bin")), T_world_layout, seen), 0.3);

  // The board now stands as much the other way, and a run sounds what was felt.
  const sensing::Rig nudged = sensing::load_rig(file("nudged.toml"));
  EXPECT_LT(glm::length(Vec3((*nudged.array->T_world_layout)[3]) - (Vec3(T_world_layout[3]) - offset)), 1e-12);
  EXPECT_EQ(nudged.cameras.size(), rig_.cameras.size());
  const Result run = succeeded(palpa_here(with(
      {"run", "--every-frame", "--rig", file("nudged.toml"), "--link", "record:" + file("run.bin"), "--hold", "1s"},
      same)));
  EXPECT_LT(phases_off(last_sound(file("run.bin")), T_world_layout, seen + offset), 2e-3);
}

TEST_F(Nudge, NothingIsSavedWithoutEnter) {
  const Result left = succeeded(palpa_here(nudge("right q")));
  EXPECT_NE(left.out.find("nothing is saved"), std::string::npos);
  expect_failure(palpa_here(nudge("right*2")), 1, "before Enter");
  expect_failure(palpa_here(nudge("wait*1000")), 1, "before Enter");  // the recording ends first
  std::vector<std::string> without_keys = nudge("right");
  without_keys.resize(without_keys.size() - 2);
  expect_failure(palpa_here(without_keys), 2, "stdin is not a terminal");
  EXPECT_FALSE(std::filesystem::exists(file("nudged.toml")));
}

/// A shell that runs it on a terminal, and then says how the terminal is.
std::string shell_line(const std::string& rest) {
  const auto assets = where_assets_are();
  return "trap : INT HUP; export " + assets.first + "='" + assets.second + "'; '" + palpa_binary() +
         "' calibrate --nudge --backend cpu --layout openmpd " + rest + "; stty -a; echo all said";
}

TEST_F(Nudge, ATerminalIsAsItWasBeforeOnEveryWayOut) {
  PALPA_TERMINAL_OR_SKIP();
  const std::string out = " --out " + file("nudged.toml");
  const auto restored = [](Terminal& terminal) {
    EXPECT_TRUE(terminal.shows("all said")) << terminal.text();
    EXPECT_NE(terminal.text().find(" icanon"), std::string::npos) << terminal.text();
    EXPECT_NE(terminal.text().find(" echo "), std::string::npos) << terminal.text();
  };
  {
    Terminal saves("sh", {"-c", shell_line(out)});
    ASSERT_TRUE(saves.shows("x +0.0")) << saves.text();
    saves.type("\x1b[C");
    EXPECT_TRUE(saves.shows("x +1.0")) << saves.text();
    saves.type("f\x1b[5~");
    EXPECT_TRUE(saves.shows("z -0.1")) << saves.text();
    saves.type("\r");
    EXPECT_TRUE(saves.shows("written to")) << saves.text();
    restored(saves);
    const Vec3 moved((*sensing::load_rig(file("nudged.toml")).array->T_world_layout)[3]);
    EXPECT_LT(glm::distance(moved, Vec3(-0.001, -0.15, 0.0001)), 1e-12);
  }
  {
    Terminal interrupted("sh", {"-c", shell_line(out)});
    ASSERT_TRUE(interrupted.shows("x +0.0")) << interrupted.text();
    interrupted.type("\x03");
    restored(interrupted);
    EXPECT_TRUE(interrupted.cut_short() || interrupted.text().find("nothing is saved") != std::string::npos)
        << interrupted.text();
  }
  {
    Terminal fails("sh", {"-c", shell_line(out + " --link record:/dev/full")});
    EXPECT_TRUE(fails.shows("No space left")) << fails.text();
    restored(fails);
  }
}

TEST_F(Nudge, KeysAreReadWhileNoFrameComes) {
  PALPA_TERMINAL_OR_SKIP();
  Terminal terminal("sh", {"-c", shell_line(" --out " + file("nudged.toml") + " --source " + recording("stuck"))});
  ASSERT_TRUE(terminal.shows("x +0.0")) << terminal.text();
  terminal.type("\x1b[C");
  EXPECT_TRUE(terminal.shows("x +1.0")) << terminal.text();
  terminal.type("\r");
  EXPECT_TRUE(terminal.shows("written to")) << terminal.text();
  EXPECT_TRUE(terminal.shows("all said")) << terminal.text();
  const Vec3 moved((*sensing::load_rig(file("nudged.toml")).array->T_world_layout)[3]);
  EXPECT_LT(glm::distance(moved, Vec3(-0.001, -0.15, 0)), 1e-12);
}

/// A rehearsal by touch with the rig of one camera.
class ByTouch : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> touch(const std::string& keys) const {
    return {"calibrate", "--by-touch", "--backend", "cpu", "--rig",  rig_,
            "--out",     file("new"),  "--hold",    "10s", "--keys", keys};
  }
  std::filesystem::path folder_ = scratch_folder("by-touch");
  std::string rig_ = where_assets_are().second + "/rigs/openmpd-one.toml";
};

std::string eight_times(const std::string& keys) {
  std::string all;
  for (std::size_t i = 0; i < setup::camera_foci.size(); ++i)
    all += keys + " ";
  return all;
}

TEST_F(ByTouch, EightTouchesGiveTheCamerasPose) {
  const Result result = succeeded(palpa_here(with(
      touch(eight_times("wait*20 enter")), {"--link", "record:" + file("drives.bin"), "--json", file("said.json")})));
  EXPECT_CONTAINS(result.out, "front left: 8 touches, ");
  EXPECT_CONTAINS(result.out, "palpa calibrate --nudge --rig " + file("new") + " refines it");
  const sensing::Rig was = sensing::load_rig(rig_), now = sensing::load_rig(file("new"));
  const json said = json::parse(read_text(file("said.json")));
  EXPECT_EQ(said["saved"], true);
  ASSERT_EQ(said["cameras"].size(), 1u);
  EXPECT_EQ(said["cameras"][0]["touches"], 8);
  EXPECT_DOUBLE_EQ(said["cameras"][0]["residual_m"].get<double>(), *now.cameras[0].residual_m);
  // The camera was in its place, and the finger within 3 mm.
  const Transform between = glm::inverse(was.cameras[0].T_world_camera) * now.cameras[0].T_world_camera;
  EXPECT_DOUBLE_EQ(said["cameras"][0]["moved_m"].get<double>(), glm::length(Vec3(between[3])));
  EXPECT_GT(glm::length(Vec3(between[3])), 1e-4) << "a new pose";
  EXPECT_LT(glm::distance(
                transform_point(now.cameras[0].T_world_camera * glm::inverse(was.cameras[0].T_world_camera), Vec3(0)),
                Vec3(0)),
            4e-3);
  // The last focus sounded where the pose says that it was touched.
  EXPECT_LT(phases_off(last_sound(file("drives.bin")), *was.array->T_world_layout, setup::camera_foci.back()), 1e-2);
}

TEST_F(ByTouch, NothingIsSavedBeforeTheLastFocus) {
  expect_failure(palpa_here(touch("wait*20 enter wait*20 enter")), 1, "before Enter was pressed at focus 3 of 8");
  expect_failure(palpa_here(touch("wait*20 enter enter")), 1,
                 "nothing is saved, because it ended at focus 2 of 8: no camera sees a fingertip");
  const Result left = succeeded(palpa_here(with(touch("wait*20 enter q"), {"--json", "-"})));
  EXPECT_EQ(json::parse(left.out)["saved"], false);
  EXPECT_FALSE(std::filesystem::exists(file("new")));
  for (const auto& [more, fault] : {std::pair("--at", "--at and --by-touch exclude each other"),
                                    {"--turn", "--turn and --by-touch exclude each other"}})
    expect_failure(palpa_here(with(touch("q"), {more, std::string(more) == "--at" ? "0,0,1cm" : "90"})), 2, fault);
  expect_failure(palpa_here(with(touch("q"), {"--nudge"})), 2, "--nudge and --by-touch exclude each other");
  expect_failure(palpa_here(with(touch("q"), {"--frames", "9"})), 2, "--frames and --by-touch exclude each other");
  expect_failure(palpa_here(with(touch("q"), {"--scene", "cube.glb"})), 2, "--by-touch and --scene exclude each other");
  expect_failure(palpa_here(with(touch("q"), {"--source", "joints:hands.jsonl"})), 2, "--by-touch goes with cameras");
}

}  // namespace
}  // namespace palpa::test
