// palpa-viewer without a window. Lines that need the program itself start it; others run in this process.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
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
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
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
    const Result run = viewer_here(with(line, {"--quiet", "--screenshot", path("shot.png")}));
    EXPECT_EQ(run.exit_code, 0) << run.err;
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
    const geometry::Mesh mesh = geometry::icosphere(6e-3, finely);
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
    const Result run = viewer(cube_touch(with(same, {"--headless", "--screenshot", path(name)})));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "b.png"));
  const drawing::Pixels a = drawing::read_png(path("a.png"));
  EXPECT_TRUE(a.width == 320 && a.height == 200);
  EXPECT_LT(drawing::mean_difference(a, pixels(host_touch(same))), 1e-4);
}

TEST_F(Viewer, AnArrayAloneIsAPicture) {
  EXPECT_EQ(pixels({"--layout", "sonicsurface", "--headless"}).width, 1280u);
}

TEST_F(Viewer, BrokenSettingsAreToldInOneLineWithoutAWindow) {
  std::filesystem::create_directory(folder_ / "palpa");
  const auto warned = [&](const std::string& text) {
    write_text(folder_ / "palpa" / "viewer.toml", text);
    const Result run = run_program(PALPA_VIEWER_BINARY, {"--headless", "--layout", "openmpd", "--size", "64x64"},
                                   {{{"DISPLAY", ""}, {"XDG_CONFIG_HOME", folder_.string()}}});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err_lines();
  };
  EXPECT_TRUE(warned("dark = true\n").empty());
  const std::vector<std::string> lines = warned("dark = 3\n");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_CONTAINS(lines[0], "palpa/viewer.toml");
  EXPECT_CONTAINS(lines[0], "does not use it");
}

TEST_F(Viewer, TheSpectrumIsAChartInItsCornerBesideWhatIsLookedAt) {
  const Line bare = host_touch({"--hide", "grid"}, "640x400");
  const drawing::Pixels without = pixels(bare), with_it = pixels(with(bare, {"--spectrum"}));
  // The chart is in its corner, and no part of the cube is there. To the right, there is more than before. To the left,
  // there is only the legend at the top.
  const auto drawn = [](const drawing::Pixels& picture, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1,
                        std::uint32_t y1) {
    std::size_t count = 0;
    for (std::uint32_t y = y0; y < y1; ++y) {
      for (std::uint32_t x = x0; x < x1; ++x)
        count += !std::equal(picture.at(x, y), picture.at(x, y) + 3, picture.at(2, 397));
    }
    return count;
  };
  EXPECT_GT(drawn(with_it, 95, 175, 504, 397), 3000u);
  EXPECT_EQ(drawn(with_it, 95, 110, 504, 170), 0u) << "between legend and chart";
  EXPECT_GT(drawn(without, 95, 110, 504, 170), 1000u) << "where the cube is without it";
  EXPECT_GT(drawn(with_it, 506, 0, 640, 380), 2000u);
}

TEST_F(Viewer, ALiveRunIsDrawnAndScripted) {
  const Line live = with(synthetic_, {"--size", "400x300"});
  const Result run = viewer(with(live, {"--frames", "2", "--screenshot", path("p.png")}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(drawing::read_png(path("p.png")).width, 400u);
  EXPECT_CONTAINS(run.out, "frame to drives: median ") << "as palpa run ends";
  const std::string played =
      script("draw 2\nkey 7\nclick 100 100\nkey h\ndraw 2\nkey o\ndraw\nshot " + path("early.png") + "\n");
  const Result scripted = viewer_here(with(live, {"--backend", "cpu", "--quiet", "--panels", "--interact", played}));
  EXPECT_EQ(scripted.exit_code, 0) << scripted.err;
  EXPECT_GT(drawing::mean_difference(drawing::read_png(path("p.png")), drawing::read_png(path("early.png"))), 0.02)
      << "panels and sheet";
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
  const Result filmed = viewer(touch(filming));
  ASSERT_EQ(filmed.exit_code, 0) << filmed.err;
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

TEST_F(Viewer, LayersAreShownAndHidden) {
  const std::string usual = shot(host_touch({})), bare = shot(host_touch({"--hide", "grid,legend"}));
  EXPECT_NE(shot(host_touch({"--show", "sections"})), usual);
  EXPECT_NE(bare, usual);
  EXPECT_EQ(shot(host_touch({"--opacity", "grid=0,legend=0"})), bare);
  ASSERT_EQ(viewer(host_touch({"--quiet", "--hide", "grid,legend", "--screenshot", path("b.png")})).exit_code, 0);
  EXPECT_EQ(read_text(path("b.png")), bare) << "the program draws the same bytes";
}

TEST_F(Viewer, TheFieldOfTheSlotStandsInAPlane) {
  std::string layout;
  for (const char* place : {"-0.05, -0.05", "0.05, -0.05", "-0.05, 0.05", "0.05, 0.05"})
    layout += "[[transducer]]\nposition_m = [" + std::string(place) + ", 0]\naxis = [0, 0, 1]\n";
  write_text(folder_ / "four.toml", layout);
  const auto touch = [&](const Line& more) {
    return shot(host_touch(with({"--layout", path("four.toml"), "--frame", "touch", "--hide", "array"}, more)));
  };
  const std::string slice = touch({"--slice", "xz", "--slice-size", "20mm"});
  for (const Line& other : std::vector<Line>{{},
                                             {"--slice", "xy", "--slice-size", "20mm"},
                                             {"--slice-at", "0,-1mm,0", "--slice-size", "20mm"},
                                             {"--slice", "xz", "--slice-size", "20mm", "--slot", "1"}})
    EXPECT_NE(touch(other), slice) << (other.empty() ? "" : other.back());
  const Result whole = viewer(
      cube_touch({"--headless", "--layout", "autd3", "--slice", "xz", "--screenshot", path("whole.png"), "--quiet"}));
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_EQ(whole.err, "");
}

TEST_F(Viewer, ThePressureOnTheFingerIsHeat) {
  const std::string finger = ball(7);
  Line touch = host_touch({"--skin", finger, "--layout", "autd3", "--frame", "touch", "--hide", "array,legend"});
  touch[3] = finger;
  touch[5] = "2mm";
  const Result run = viewer(with(touch, {"--show", "heat", "--screenshot", path("heat.png")}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // Almost black where nothing is felt, lightest where most is felt.
  const drawing::Pixels heat = drawing::read_png(path("heat.png"));
  std::size_t dark = 0, light = 0;
  for (std::size_t i = 0; i < heat.rgba.size(); i += 4) {
    dark += heat.rgba[i + 1] < 40;
    light += heat.rgba[i] > 200 && heat.rgba[i + 2] < 120;
  }
  EXPECT_GT(dark, 2000u);
  EXPECT_GT(light, 200u);
  EXPECT_EQ(pixels(with(touch, {"--heat", "pressure"})).rgba, heat.rgba);
  EXPECT_NE(pixels(with(touch, {"--heat", "PC"})).rgba, heat.rgba) << "rates have the same colours";
}

TEST_F(Viewer, AParticipantSeesTheObjectWithEitherEye) {
  const auto line = [&](const Line& more, const char* size = "320x180") {
    return with({"--participant", "--scene", source_file("assets/pyramid.glb").string(), "--headless", "--size", size},
                more);
  };
  const drawing::Pixels both = pixels(line({"--stereo", "side-by-side"}));
  const drawing::Pixels tile = pixels(line({"--stereo", "side-by-side", "--hide", "solids,edges"}));
  EXPECT_EQ(both.width, 320u);
  // The tile is the same in both; for the left eye, it is farther to the right, because it is in front of the screen.
  const auto middle = [&](std::uint32_t first) {
    double sum = 0, count = 0;
    for (std::uint32_t y = 0; y < 180; ++y) {
      for (std::uint32_t x = first; x < first + 160; ++x) {
        if (tile.at(x, y)[2] > 200) continue;
        sum += x - first;
        ++count;
      }
    }
    EXPECT_GT(count, 5) << first;
    return sum / count;
  };
  EXPECT_GT(middle(0), middle(160) + 3);
  EXPECT_GT(drawing::mean_difference(both, tile), 0.002);
  EXPECT_GT(drawing::mean_difference(pixels(line({"--stereo", "columns"})), pixels(line({}))), 0.002);
  ASSERT_EQ(viewer(line({"--stereo", "top-bottom", "--screenshot", path("odd.png")}, "321x181")).exit_code, 0);
  for (const drawing::Pixels& odd :
       {pixels(line({"--stereo", "side-by-side"}, "321x181")), drawing::read_png(path("odd.png"))})
    EXPECT_TRUE(odd.width == 321 && odd.height == 181) << odd.width << "x" << odd.height;
}

TEST_F(Viewer, AScriptThatEndsWhileARunLoadsIsNoSuccess) {
  const Line live = with(live_, {"--quiet", "--interact", path("script"), "--screenshot", path("shot.png")});
  script("draw\n");
  Line absent = live;
  absent[1] = path("absent.glb");
  expect_failure(viewer_here(absent), 4, "absent.glb");
  EXPECT_EQ(viewer_here(live).exit_code, 0);
  EXPECT_LT(drawing::read_png(path("shot.png")).at(160, 120)[0], 250) << "the scene, not an empty picture";
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
  // Escape cancels the loading, also before a picture has shown it, and does not end the viewer.
  script("draw\n" + drop + "key escape\ndraw\nshot " + shot + "\n");
  EXPECT_EQ(viewer_here(line).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(shot));
}

TEST_F(Viewer, ARecordingThatIsDroppedOnATouchIsALiveRun) {
  ASSERT_EQ(viewer_here(with(live_, {"--record", path("take"), "--quiet", "--frames", "40"})).exit_code, 0);
  script("draw\nshot " + path("touch.png") + "\ndrop " + path("take") + "\ndraw\n");
  const Result dropped = viewer(host_touch({"--layout", "autd3", "--hide", "legend", "--frame", "objects",
                                            "--screenshot", path("live.png"), "--interact", path("script")}));
  EXPECT_EQ(dropped.exit_code, 0) << dropped.err;
  EXPECT_EQ(dropped.err, "");
  EXPECT_GT(drawing::mean_difference(drawing::read_png(path("touch.png")), drawing::read_png(path("live.png"))), 1e-4)
      << "what cameras saw";
}

TEST_F(Viewer, ComparesWithAReference) {
  const auto compared = [&](const Line& drawn, const Line& more, const char* size = "320x200") {
    EXPECT_EQ(viewer_here(host_touch(with(drawn, {"--screenshot", path("other.png"), "--quiet"}), size)).exit_code, 0);
    return viewer_here(host_touch(with(more, {"--reference", path("other.png"), "--quiet"})));
  };
  EXPECT_EQ(compared({}, {"--threshold", "0"}).exit_code, 0);
  expect_failure(compared({"--dark"}, {}), 1, "other.png");
  EXPECT_EQ(compared({"--dark"}, {"--threshold", "0.99"}).exit_code, 0);
  expect_failure(compared({}, {}, "300x200"), 4, "300x200");
}

TEST_F(Viewer, ReportsAsJson) {
  const Result run = viewer(host_touch({"--frames", "2", "--json", "-"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["width"], 320);
  EXPECT_GT(json["timing_ms"]["frame"].get<double>(), 0);
  EXPECT_GE(json["timing_ms"]["frame_p95"].get<double>(), json["timing_ms"]["frame"].get<double>());
}

TEST_F(Viewer, LooksThroughTheCameraOfThatName) {
  sensing::Camera camera;
  camera.name = "from above";
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 100;
  camera.cx = 31.5;
  camera.cy = 23.5;
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

}  // namespace
}  // namespace palpa::test
