// palpa-viewer without a window. Lines that need the program itself start it; others run in this process.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "drawing/png.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig.hpp"
#include "setup/sessions/study_plan.hpp"
#include "study/sitting/record.hpp"
#include "study/sitting/rehearsal.hpp"
#include "support/cameras.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer_here.hpp"

namespace palpa::test {
namespace {

using Line = std::vector<std::string>;

class Viewer : public DrawingTest {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The bytes of the picture of a line, drawn within this process; it is in "shot.png" then.
  std::string shot(const Line& line) {
    succeeded(viewer_here(with(line, {"--quiet", "--screenshot", path("shot.png")})));
    return read_text(folder_ / "shot.png");
  }
  drawing::Pixels pixels(const Line& line) {
    shot(line);
    return drawing::read_png(path("shot.png"));
  }
  std::string script(const std::string& text) {
    write_text(folder_ / "script", text);
    return path("script");
  }
  std::string ball(int finely) {
    geometry::Mesh mesh = geometry::icosphere(6e-3, finely);
    for (Vec3& p : mesh.positions)
      p.y += 6e-3;  // its tip is at the origin
    geometry::write_ply(path("ball.ply"), mesh.positions, mesh.triangles);
    return path("ball.ply");
  }

  const std::filesystem::path folder_ = scratch_folder("viewer-program");
  const std::string cube_ = source_file("assets/cube.glb").string();
  const Line synthetic_{"--scene", cube_, "--source", "synthetic", "--layout", "autd3", "--headless"};
  const Line live_ = with(synthetic_, {"--backend", "cpu", "--noise-free", "--size", "320x200"});
};

TEST_F(Viewer, TheSameCommandGivesTheSameBytesWithoutADisplayOnEitherBackend) {
  const Line same{"--frames", "3", "--skin", source_file("assets/finger.ply").string()};
  for (const char* name : {"a.png", "b.png"}) {
    const Result run = succeeded(viewer(cube_touch(with(same, {"--headless", "--screenshot", path(name)}))));
    EXPECT_EQ(run.err, "");
  }
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "b.png"));
  const drawing::Pixels a = drawing::read_png(path("a.png"));
  EXPECT_TRUE(a.width == 320 && a.height == 200);
  EXPECT_LT(drawing::mean_difference(a, pixels(host_touch(same))), 1e-4);
}

TEST_F(Viewer, BrokenSettingsAreToldInOneLineWithoutAWindow) {
  std::filesystem::create_directory(folder_ / "palpa");
  const auto warned = [&](const std::string& text) {
    write_text(folder_ / "palpa" / "viewer.toml", text);
    const Result run =
        succeeded(run_program(PALPA_VIEWER_BINARY, {"--headless", "--layout", "openmpd", "--size", "64x64"},
                              {{{"DISPLAY", ""}, {"XDG_CONFIG_HOME", folder_.string()}}}));
    return run.err_lines();
  };
  EXPECT_TRUE(warned("dark = true\n").empty());
  const std::vector<std::string> lines = warned("dark = 3\n");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_CONTAINS(lines[0], "palpa/viewer.toml");
  EXPECT_CONTAINS(lines[0], "does not use it");
}

TEST_F(Viewer, ALiveRunIsDrawnAndScripted) {
  const Line live = with(synthetic_, {"--size", "400x300"});
  const Result run = succeeded(viewer(with(live, {"--frames", "2", "--screenshot", path("p.png")})));
  EXPECT_EQ(drawing::read_png(path("p.png")).width, 400u);
  EXPECT_CONTAINS(run.out, "frame to drives: median ") << "as palpa run ends";
  const std::string played =
      script("draw 2\nkey 7\nclick 100 100\nkey h\ndraw 2\nkey o\ndraw\nshot " + path("early.png") + "\n");
  succeeded(viewer_here(with(live, {"--backend", "cpu", "--quiet", "--panels", "--interact", played})));
  EXPECT_GT(drawing::mean_difference(drawing::read_png(path("p.png")), drawing::read_png(path("early.png"))), 0.02)
      << "panels and sheet";
}

/// How many pixels are within 2 % of that colour.
std::size_t count_of(const drawing::Pixels& picture, const drawing::Colour& colour) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const auto near = [&](std::size_t c, float wanted) {
      return std::abs(picture.rgba[i + c] / 255.0F - wanted) < 0.02F;
    };
    count += near(0, colour.r) && near(1, colour.g) && near(2, colour.b) ? 1 : 0;
  }
  return count;
}

TEST_F(Viewer, APictureOfARunWaitsForATouchAndForItsSound) {
  const Line run{"--scene",    cube_,         "--source", "synthetic:" + ball(7), "--layout", "autd3",
                 "--headless", "--backend",   "cpu",      "--noise-free",         "--size",   "320x200",
                 "--hide",     "array,legend"};
  const auto orange = [](const drawing::Pixels& picture) { return count_of(picture, viewer::finger_colour(0)); };
  EXPECT_GT(orange(pixels(run)), 20u) << "the finger's foci, in the close-up";
  EXPECT_GT(orange(pixels(with(run, {"--frames", "2", "--at-touch"}))), 20u);
  // Purple to red: the middle of the map, and nothing else in the picture.
  const auto mapped = [](const drawing::Pixels& picture) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
      const int red = picture.rgba[i], green = picture.rgba[i + 1], blue = picture.rgba[i + 2];
      count += red > green + 40 && blue > green + 15 ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(mapped(pixels(run)), 0u);
  EXPECT_GT(mapped(pixels(with(run, {"--show", "slice"}))), 20u);
  EXPECT_GT(mapped(pixels(with(run, {"--show", "heat", "--eye", "0.012,-0.002,0.02"}))), 20u);
}

TEST_F(Viewer, APictureThatWaitedForNothingSaysHowFarTheSkinWas) {
  const Line take{"run",          "--scene",   cube_, "--frames", "5",          "--every-frame",
                  "--noise-free", "--backend", "cpu", "--record", path("take"), "--quiet"};
  succeeded(palpa(take));
  const geometry::SceneMesh low{"low", test::box({-0.02, -0.12, -0.02}, {0.02, -0.08, 0.02})};
  geometry::write_glb(folder_ / "low.glb", std::span(&low, 1));
  const Result run = succeeded(
      viewer({"--scene", path("low.glb"), "--source", "recording:" + path("take"), "--layout", "autd3", "--headless",
              "--backend", "cpu", "--size", "320x200", "--every-frame", "--screenshot", path("p.png")}));
  const std::string before = "nothing touched while the picture waited, for up to 5 s: the nearest skin is ";
  const std::size_t at = run.err.find(before);
  ASSERT_NE(at, std::string::npos) << run.err;
  EXPECT_NEAR(std::atof(run.err.c_str() + at + before.size()), 80, 20);
  EXPECT_CONTAINS(run.err, "mm away from the surface of low");
}

TEST_F(Viewer, AFingersSkinOnThePointsOfAHandIsTold) {
  const geometry::Ply finger = geometry::read_ply(source_file("assets/finger.ply"));
  std::vector<Vec3> hand = finger.positions;
  for (const double x : {0.03, 0.06}) {
    for (const Vec3& p : finger.positions)
      hand.push_back(p + Vec3(x, 0.02, 0));
  }
  geometry::write_ply(path("hand.ply"), hand, {});
  Line line = cube_touch({"--headless", "--skin", source_file("assets/finger.ply").string()});
  EXPECT_EQ(viewer(line).err, "");
  line[3] = path("hand.ply");
  const Result run = succeeded(viewer(line));
  const std::string said = "finger.ply is not the surface of --points " + path("hand.ply") + ": ";
  const std::size_t at = run.err.find(said);
  ASSERT_NE(at, std::string::npos) << run.err;
  EXPECT_NEAR(std::atof(run.err.c_str() + at + said.size()), 200.0 / 3, 4) << "two of three fingers; " << run.err;
}

TEST_F(Viewer, FramesAdvanceTheRunningFocusAndAVideoIsEveryFrame) {
  const auto touch = [](const Line& more) { return host_touch(with({"--frame", "touch"}, more)); };
  const auto pictures_in = [](const std::string& film) {
    return std::distance(std::filesystem::directory_iterator(film), {});
  };
  const std::string first = shot(touch({})), second = shot(touch({"--frames", "2"}));
  EXPECT_NE(second, first);
  EXPECT_EQ(shot(touch({"--slot", "1"})), second);
  const Line filming{"--frames", "11", "--video", path("film"), "--screenshot", path("last.png")};
  const Result filmed = succeeded(viewer(touch(filming)));
  EXPECT_CONTAINS(filmed.out, path("film"));
  EXPECT_EQ(pictures_in(path("film")), 11);
  EXPECT_EQ(read_text(path("film/000001.png")), second);
  EXPECT_EQ(read_text(path("film/000010.png")), first) << "ten foci: one full turn";
  EXPECT_EQ(read_text(path("last.png")), first);
  expect_failure(viewer_here(touch(filming)), 2, "not empty");
  const std::string last = shot(with(live_, {"--frames", "3", "--video", path("live")}));
  EXPECT_EQ(read_text(path("live/000002.png")), last);
  EXPECT_EQ(pictures_in(path("live")), 3);
}

TEST_F(Viewer, ASensationIsDrawnSlotBySlot) {
  const auto circle = [](const Line& more) {
    return with({"--sensation", "circle", "--headless", "--size", "320x200", "--layout", "openmpd"}, more);
  };
  const std::string first = shot(circle({})), tenth = shot(circle({"--slot", "9"}));
  EXPECT_NE(first, tenth);
  EXPECT_EQ(shot(circle({"--frames", "10"})), tenth);
  EXPECT_NE(shot(circle({"--slot", "9", "--param", "radius=20"})), tenth);
  EXPECT_NE(shot(circle({"--slot", "9", "--show", "slice"})), tenth);
  const std::filesystem::path file = folder_ / "circle.adaptics";
  std::filesystem::copy_file(source_file("assets/sensations/circle.adaptics"), file);
  const Line of_file = {"--sensation", file.string(), "--headless", "--size", "320x200",
                        "--layout",    "openmpd",     "--slot",     "9"};
  EXPECT_EQ(shot(of_file), tenth);
  expect_failure(viewer_here(with({"--sensation"}, {"nobody", "--headless"})), 4,
                 "neither a file nor a known sensation");
}

TEST_F(Viewer, EveryOptionOfThePictureHasItsEffect) {
  std::string layout;
  for (const char* place : {"-0.05, -0.05", "0.05, -0.05", "-0.05, 0.05", "0.05, 0.05"})
    layout += "[[transducer]]\nposition_m = [" + std::string(place) + ", 0]\naxis = [0, 0, 1]\n";
  write_text(folder_ / "four.toml", layout);
  const Line usual = host_touch({}), bare = host_touch({"--hide", "grid,legend"});
  const auto slice = [&](const Line& more) {
    return host_touch(with({"--layout", path("four.toml"), "--frame", "touch", "--hide", "array"}, more));
  };
  const Line plane = slice({"--slice", "xz", "--slice-size", "20mm"});
  const std::string finger = ball(7);
  const auto heat = [&](const Line& more) {
    Line touch =
        host_touch(with({"--skin", finger, "--layout", "autd3", "--frame", "touch", "--hide", "array,legend"}, more));
    touch[3] = finger;
    touch[5] = "2mm";
    return touch;
  };
  struct Case {
    Line one, other;
    bool same;
  };
  std::map<Line, std::string> shots;
  for (const Case& each : {Case{usual, host_touch({"--show", "sections"}), false},
                           {host_touch({}, "640x400"), host_touch({"--spectrum"}, "640x400"), false},
                           {usual, bare, false},
                           {host_touch({"--opacity", "grid=0,legend=0"}), bare, true},
                           {plane, slice({}), false},
                           {plane, slice({"--slice", "xy", "--slice-size", "20mm"}), false},
                           {plane, slice({"--slice-at", "0,-1mm,0", "--slice-size", "20mm"}), false},
                           {plane, slice({"--slice", "xz", "--slice-size", "20mm", "--slot", "1"}), false},
                           {heat({"--heat", "pressure"}), heat({"--show", "heat"}), true},
                           {heat({"--heat", "PC"}), heat({"--show", "heat"}), false}}) {
    for (const Line& line : {each.one, each.other}) {
      if (!shots.contains(line)) shots[line] = shot(line);
    }
    EXPECT_EQ(shots[each.one] == shots[each.other], each.same) << each.one.back() << ", " << each.other.back();
  }
  succeeded(viewer(with(bare, {"--quiet", "--screenshot", path("b.png")})));
  EXPECT_EQ(read_text(path("b.png")), shots[bare]) << "the program draws the same bytes";
}

TEST_F(Viewer, AParticipantsPictureIsOfBothEyesAndKeepsAnOddSize) {
  const auto line = [&](const std::string& stereo, const char* size) {
    return Line{"--participant", "--scene", source_file("assets/pyramid.glb").string(), "--headless", "--size", size,
                "--stereo",      stereo};
  };
  EXPECT_GT(drawing::mean_difference(pixels(line("columns", "320x180")), pixels(line("none", "320x180"))), 0.002);
  succeeded(viewer(with(line("top-bottom", "321x181"), {"--screenshot", path("odd.png")})));
  for (const drawing::Pixels& odd : {pixels(line("side-by-side", "321x181")), drawing::read_png(path("odd.png"))})
    EXPECT_TRUE(odd.width == 321 && odd.height == 181) << odd.width << "x" << odd.height;
}

TEST_F(Viewer, AScriptThatEndsWhileARunLoadsIsNoSuccess) {
  const Line live = with(live_, {"--quiet", "--interact", path("script"), "--screenshot", path("shot.png")});
  script("draw\n");
  Line absent = live;
  absent[1] = path("absent.glb");
  expect_failure(viewer_here(absent), 4, "absent.glb");
  succeeded(viewer_here(live));
  const drawing::Pixels shot = drawing::read_png(path("shot.png"));
  std::uint32_t drawn = 0;
  for (std::uint32_t y = 0; y < shot.height; ++y) {
    for (std::uint32_t x = 0; x < shot.width; ++x)
      drawn += shot.at(x, y)[0] < 250 ? 1 : 0;
  }
  EXPECT_GT(drawn, shot.width * shot.height / 10) << "the scene, not an empty picture";
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);  // nobody ever reads from it
  script("draw\nkey q\n");
  const Result ended = viewer(with(live, {"--events", path("pipe")}));
  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  ASSERT_FALSE(ended.err_lines().empty());
  // On a slow machine, the warning that the pipe has no reader comes first.
  EXPECT_CONTAINS(ended.err_lines().back(), "palpa: error: ended while the run was loading");
}

TEST_F(Viewer, AScriptThatEndsWhileADroppedFileLoadsSaysWhichPictureIsMissing) {
  // It is still loading when the next line is played.
  const geometry::SceneMesh large{"ball", geometry::icosphere(0.05, instrumented() ? 25 : 80)};
  geometry::write_glb(folder_ / "ball.glb", std::span(&large, 1));
  const std::string shot = path("shot.png"), drop = "drop " + path("ball.glb") + "\n";
  const Line line = host_touch({"--quiet", "--interact", path("script")});
  script("draw\nshot " + shot + "\n" + drop + "key q\n");
  expect_failure(viewer(line), 1, shot + ": is not written");
  EXPECT_FALSE(std::filesystem::exists(shot));
}

TEST_F(Viewer, ComparesWithAReference) {
  const auto compared = [&](const Line& drawn, const Line& more, const char* size = "320x200") {
    succeeded(viewer_here(host_touch(with(drawn, {"--screenshot", path("other.png"), "--quiet"}), size)));
    return viewer_here(host_touch(with(more, {"--reference", path("other.png"), "--quiet"})));
  };
  EXPECT_EQ(compared({}, {"--threshold", "0"}).exit_code, 0);
  expect_failure(compared({"--dark"}, {}), 1, "other.png");
  EXPECT_EQ(compared({"--dark"}, {"--threshold", "0.99"}).exit_code, 0);
  expect_failure(compared({}, {}, "300x200"), 4, "is 300x200 pixels, but the picture is 320x200: give --size 300x200");
}

TEST_F(Viewer, ReportsAsJson) {
  const Result run = succeeded(viewer(host_touch({"--frames", "2", "--json", "-"})));
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["width"], 320);
  EXPECT_GT(json["timing_ms"]["frame"].get<double>(), 0);
  EXPECT_GE(json["timing_ms"]["frame_p95"].get<double>(), json["timing_ms"]["frame"].get<double>());
}

TEST_F(Viewer, LooksThroughTheCameraOfThatName) {
  sensing::Camera camera = pinhole("from above", 64, 48, 100);
  camera.T_world_camera = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0.2, 0, 1}};  // columns: it looks down
  write_text(folder_ / "camera.toml", sensing::to_toml(sensing::Rig{"", {camera}, {}, {}}));
  sensing::write_png16(folder_ / "depth.png", 64, 48, std::vector<std::uint16_t>(64 * 48, 199));  // in the cube
  const auto line = [&](const std::string& view, const Line& more) {
    return with({"--scene", cube_, "--camera", path("camera.toml"), "--depth", path("depth.png"), "--view", view,
                 "--size", "320x240", "--backend", "cpu", "--headless", "--hide", "legend,grid"},
                more);
  };
  const std::string first = shot(line("camera:from above", {}));
  // The cube's top is 40 mm wide and 0.2 m away: 100 pixels in the middle of the picture.
  const drawing::Pixels seen = drawing::read_png(path("shot.png"));
  EXPECT_GT(seen.at(110 - 8, 120)[0], 250);
  EXPECT_LT(seen.at(110 + 8, 120)[0], 240);
  EXPECT_EQ(shot(line("camera", {"--show", "depth"})), first) << "its own image does not hide what it sees";
  expect_failure(viewer_here(line("camera:from below", {})), 2, "unknown camera 'from below'; give one of from above");
}

TEST_F(Viewer, HelpAndVersion) {
  const Result usual = viewer({"--help"}), all = viewer({"--help", "all"});
  EXPECT_EQ(usual.exit_code, 0);
  EXPECT_EQ(all.exit_code, 0);
  for (const char* part : {"--scene", "--headless", "--screenshot", "--layout", "Exit codes"}) {
    EXPECT_CONTAINS(usual.out, part);
    EXPECT_CONTAINS(all.out, part);
  }
  for (const char* part : {"--delta", "--gpu"}) {
    EXPECT_EQ(usual.out.find(part), std::string::npos) << part;
    EXPECT_CONTAINS(all.out, part);
  }
  EXPECT_LE(std::count(usual.out.begin(), usual.out.end(), '\n'), 40);
  std::istringstream lines(usual.out + all.out);
  for (std::string text; std::getline(lines, text);)
    EXPECT_LE(text.size(), 100u) << text;
  EXPECT_TRUE(viewer({"--version"}).out.starts_with("palpa-viewer "));
}

TEST_F(Viewer, ValidationIsSilent) {
  if (instrumented()) GTEST_SKIP() << "skipped: the layer leaks by itself, which a leak checker would report";
  for (const char* preset : {"core", "sync"}) {
    const Result run =
        viewer(cube_touch({"--headless", "--frames", "3", "--layout", "autd3", "--inset", "--validation", preset}));
    if (run.exit_code == 3 && run.err.find("vulkan-validationlayers") != std::string::npos) GTEST_SKIP() << run.err;
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
}

/// A program that was killed after the last answer left nothing to sound or to show.
TEST_F(Viewer, CompletesAStudyWithoutADisplay) {
  const std::string file = source_file("assets/studies/five-minutes.toml");
  const study::StudyPlan plan = setup::load_plan(file);
  const std::filesystem::path journal = folder_ / "study/sub-01/sub-01_journal.jsonl";
  {
    study::Record record(plan, 1, folder_ / "study", true);
    const study::Entry start{.text = study::utc_now(), .version = "v", .rehearsal = true};
    ASSERT_TRUE(study::rehearse(plan, record.agenda(), start, study::ScriptedParticipant(0.5, 1, 1),
                                [&](const study::Entry& entry) { record.add(entry); }));
  }
  const std::string text = read_text(journal);
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  EXPECT_CONTAINS(text.substr(last), "finish");
  write_text(journal, text.substr(0, last));
  const Line line{"--study", file, "--participant", "1", "--out", path("study"), "--rehearse", "0.5"};
  const Result completed = succeeded(viewer(line));
  EXPECT_CONTAINS(completed.out, "participant 1: 31 of 31 steps complete");
  EXPECT_CONTAINS(read_text(journal).substr(last), "finish");
  expect_failure(viewer(line), 2, "participant 1 has finished");
  expect_failure(viewer({"--study", file, "--participant", "2", "--out", path("study"), "--rehearse", "0.5"}), 3,
                 "no display");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "study/sub-02"));
}

}  // namespace
}  // namespace palpa::test
