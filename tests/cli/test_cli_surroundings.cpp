// What cameras see besides the hand, in `palpa run`, `palpa export` and `palpa calibrate --background`.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/told.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/rig.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

class Surroundings : public testing::Test {
 protected:
  std::filesystem::path folder = scratch_folder("surroundings");
  std::string rig = source_file("tests/cli/support/small_rig.toml").string();
  std::string hand = source_file("assets/hand.glb").string();
  std::string cube = source_file("assets/cube.glb").string();

  std::string in(const std::string& name) const { return (folder / name).string(); }

  /// An export's JSON; `err` gets what it wrote on stderr.
  json exported(const std::vector<std::string>& words, std::string* err = nullptr, int frames = 5) const {
    const Result result = succeeded(palpa_here(with({"export", "--backend", "cpu", "--frames", std::to_string(frames),
                                                     "--events", in("all.jsonl"), "--json", in("all.json")},
                                                    words)));
    if (err) *err = result.err;
    return json::parse(read_text(in("all.json")));
  }
  /// The deepest touch of the last export.
  double deepest() const {
    double most = 0;
    std::istringstream lines(read_text(in("all.jsonl")));
    for (std::string text; std::getline(lines, text);)
      most = std::max(most, json::parse(text)["depth_m"].get<double>());
    return most;
  }

  /// The small rig with more lines.
  std::string rig_with(const std::string& more) const {
    write_text(in("more.toml"), read_text(rig) + more);
    return in("more.toml");
  }
};

TEST_F(Surroundings, BoardsThatReachIntoTheObjectAreNoSkinUnlessKept) {
  std::string err;
  const json counted = exported({"--scene", hand, "--rig", rig}, &err, 1);
  EXPECT_GT(counted["dropped"]["boards"], 100);
  EXPECT_EQ(counted["dropped"]["screen"], 0);
  EXPECT_CONTAINS(err, "hand.glb: mesh \"hand\" reaches into");
  EXPECT_CONTAINS(err, "--keep-boards");
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  const double without_boards = deepest();
  EXPECT_LT(without_boards, 0.012);
  EXPECT_FALSE(exported({"--scene", hand, "--rig", rig, "--keep-boards", "--quiet"}, &err, 1).contains("dropped"));
  EXPECT_EQ(err, "");
  EXPECT_GT(deepest(), without_boards + 5e-3) << "a false touch deep inside";
}

TEST_F(Surroundings, ScreenAndRoomDropWhatIsThere) {
  // The screen lies in the finger, so its tip is dropped, and the finger touches nothing.
  const std::string screen = rig_with(
      "[screen]\nwidth_m = 0.2\nheight_m = 0.2\nT_world_screen = [[1, 0, 0, 0], [0, 0, 1, 0.01], [0, -1, 0, 0], "
      "[0, 0, 0, 1]]\neye_m = [0, 0.1, 0.6]\n");
  std::string err;
  const json on_screen = exported({"--scene", cube, "--rig", screen}, &err);
  EXPECT_GT(on_screen["dropped"]["screen"], 10);
  EXPECT_EQ(on_screen["touching"], 0);
  EXPECT_CONTAINS(err, "reaches into the screen");

  const auto in_room = [&](const std::string& high) {
    return rig_with("[room]\nlow_m = [-0.1, -0.1, -0.1]\nhigh_m = " + high + "\n");
  };
  const json inside = exported({"--scene", cube, "--rig", in_room("[0.1, 0.1, 0.1]")});
  EXPECT_EQ(inside["dropped"]["room"], 0);
  EXPECT_GT(inside["touching"], 0);
  const json cut = exported({"--scene", cube, "--rig", in_room("[0.1, -0.01, 0.1]")});
  EXPECT_GT(cut["dropped"]["room"], 20);
  EXPECT_EQ(cut["touching"], 0);

  expect_refused({"run", "--scene", cube, "--frames", "1", "--backend", "cpu", "--rig"},
                 {{{rig_with("[room]\nlow_m = [1, 1, 1]\nhigh_m = [2, 2, 2]\n")},
                   "more.toml: line 23: the room contains no solid",
                   4}});
}

TEST_F(Surroundings, ABackgroundThatWasLearnedIsNoSkin) {
  const geometry::Mesh stick = box({-0.006, -0.02, -0.006}, {0.006, 0.03, 0.006});  // it stands in the cube
  geometry::write_ply(in("stick.ply"), stick.positions, stick.triangles);
  const Result learned =
      succeeded(palpa_here({"calibrate", "--background", "--rig", rig, "--source", "synthetic:" + in("stick.ply"),
                            "--frames", "20", "--out", in("quiet.toml"), "--json", in("learned.json")}));
  EXPECT_EQ(learned.err, "");
  const json said = json::parse(read_text(in("learned.json")));
  EXPECT_EQ(said["frames"], 20);
  const json& camera = said["cameras"][0];
  EXPECT_EQ(camera["file"], in("quiet-front-left.png"));
  EXPECT_GT(camera["pixels"], 20'000);
  EXPECT_LT(camera["margin_m"], 0.012);
  const sensing::Rig quiet = sensing::load_rig(in("quiet.toml"));
  ASSERT_NE(quiet.cameras[0].background, nullptr);
  EXPECT_EQ(quiet.cameras[0].background->margin_m, camera["margin_m"]);
  EXPECT_CONTAINS(read_text(in("quiet.toml")), "background = \"quiet-front-left.png\"");

  // In five frames, the source's motion moves the stick by less than the noise.
  const auto seen = [&](const std::string& with_rig) {
    return exported({"--scene", cube, "--rig", with_rig, "--source", "synthetic:" + in("stick.ply"), "--seed", "5"});
  };
  const json noisy = seen(rig), clean = seen(in("quiet.toml"));
  EXPECT_EQ(noisy["dropped"]["background"], 0);
  EXPECT_GT(noisy["touching"], 2);
  EXPECT_GT(clean["dropped"]["background"], 100);
  EXPECT_EQ(clean["touching"], 0);
  write_text(in("other.toml"),
             read_text(in("quiet.toml")).replace(read_text(in("quiet.toml")).find("front left"), 10, "front right"));
  expect_refused({"run", "--scene", cube, "--rig", in("other.toml"), "--frames", "1"},
                 {{{}, "quiet-front-left.png: is of the camera front left", 4}});
}

}  // namespace
}  // namespace palpa::test
