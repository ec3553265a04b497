// palpa-viewer without a window: each test runs one line with the program; similar lines that draw or are refused run
// in this process.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>

#include "cli/support/process.hpp"
#include "drawing/png.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer_here.hpp"

namespace palpa {
namespace {

using Viewer = test::DrawingTest;

using test::cube_touch;
using test::host_touch;
using test::source_file;
using test::viewer;
using test::viewer_here;

TEST_F(Viewer, WritesAScreenshotWithoutADisplay) {
  const auto folder = test::scratch_folder("viewer-shot");
  const std::string shot = (folder / "p.png").string();
  const auto run = viewer(cube_touch(
      {"--headless", "--frames", "3", "--screenshot", shot, "--skin", source_file("assets/finger.ply").string()}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const drawing::Pixels pixels = drawing::read_png(shot);
  EXPECT_EQ(pixels.width, 320u);
  EXPECT_EQ(pixels.height, 200u);
}

TEST_F(Viewer, BrokenSettingsAreToldInOneLineWithoutAWindow) {
  const auto folder = test::scratch_folder("viewer-broken-settings");
  std::filesystem::create_directory(folder / "palpa");
  const auto warned = [&](const std::string& text) {
    std::ofstream(folder / "palpa" / "viewer.toml") << text;
    const auto run = test::run_program(PALPA_VIEWER_BINARY, {"--headless", "--layout", "openmpd", "--size", "64x64"},
                                       {{{"DISPLAY", ""}, {"XDG_CONFIG_HOME", folder.string()}}});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err_lines();
  };
  EXPECT_TRUE(warned("dark = true\n").empty());
  const std::vector<std::string> lines = warned("dark = 3\n");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("palpa/viewer.toml"), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("does not use it"), std::string::npos) << lines[0];
}

TEST_F(Viewer, TheSameCommandGivesTheSameBytesOnEitherBackend) {
  const auto folder = test::scratch_folder("viewer-same");
  const std::string a = (folder / "a.png").string(), b = (folder / "b.png").string(), c = (folder / "c.png").string();
  ASSERT_EQ(viewer(cube_touch({"--headless", "--screenshot", a, "--quiet"})).exit_code, 0);
  ASSERT_EQ(viewer(cube_touch({"--headless", "--screenshot", b, "--quiet"})).exit_code, 0);
  ASSERT_EQ(viewer_here(host_touch({"--screenshot", c, "--quiet"})).exit_code, 0);
  EXPECT_EQ(test::read_text(a), test::read_text(b));
  EXPECT_LT(drawing::mean_difference(drawing::read_png(a), drawing::read_png(c)), 1e-4);
}

TEST_F(Viewer, TheSpectrumIsAChartInItsCornerBesideWhatIsLookedAt) {
  const auto folder = test::scratch_folder("viewer-spectrum");
  const std::string a = (folder / "a.png").string(), b = (folder / "b.png").string();
  const std::vector<std::string> more{"--quiet", "--hide", "grid", "--screenshot"};
  ASSERT_EQ(viewer_here(host_touch(test::with(more, {a}), "640x400")).exit_code, 0);
  ASSERT_EQ(viewer(host_touch(test::with(more, {b, "--spectrum"}), "640x400")).exit_code, 0);
  const drawing::Pixels without = drawing::read_png(a), with = drawing::read_png(b);
  // The chart is in its corner, and no part of the cube is there. To the right, there is more than before. To the left,
  // there is only the legend at the top.
  const auto drawn = [](const drawing::Pixels& pixels, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1,
                        std::uint32_t y1) {
    std::size_t count = 0;
    for (std::uint32_t y = y0; y < y1; ++y) {
      for (std::uint32_t x = x0; x < x1; ++x)
        count += !std::equal(pixels.at(x, y), pixels.at(x, y) + 3, pixels.at(2, 397));
    }
    return count;
  };
  EXPECT_GT(drawn(with, 95, 175, 504, 397), 3000u);
  EXPECT_EQ(drawn(with, 95, 110, 504, 170), 0u) << "between legend and chart";
  EXPECT_GT(drawn(without, 95, 110, 504, 170), 1000u) << "where the cube is without it";
  EXPECT_GT(drawn(with, 506, 0, 640, 380), 2000u);
  const auto nothing = viewer_here({"--scene", source_file("assets/cube.glb").string(), "--headless", "--spectrum"});
  test::expect_failure(nothing, 2, "--spectrum");
}

TEST_F(Viewer, ALiveRunIsDrawnAndScripted) {
  const auto folder = test::scratch_folder("viewer-live");
  const std::string shot = (folder / "p.png").string(), early = (folder / "early.png").string();
  std::ofstream(folder / "log") << "draw 2\nkey 7\nclick 100 100\nkey h\ndraw 2\nkey o\ndraw\nshot " << early << "\n";
  const std::vector<std::string> live{"--scene",    source_file("assets/cube.glb").string(),
                                      "--source",   "synthetic",
                                      "--layout",   "autd3",
                                      "--headless", "--size",
                                      "400x300"};
  const auto run = viewer(test::with(live, {"--frames", "2", "--screenshot", shot}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(drawing::read_png(shot).width, 400u);
  EXPECT_NE(run.out.find("frame to drives: median "), std::string::npos) << "as palpa run ends: " << run.out;
  const auto scripted = viewer_here(
      test::with(live, {"--backend", "cpu", "--quiet", "--panels", "--interact", (folder / "log").string()}));
  EXPECT_EQ(scripted.exit_code, 0) << scripted.err;
  EXPECT_GT(drawing::mean_difference(drawing::read_png(shot), drawing::read_png(early)), 0.02) << "panels and sheet";

  test::expect_failure(viewer_here({"--scene", "/nowhere.glb", "--source", "synthetic", "--headless"}), 4,
                       "/nowhere.glb");
  test::expect_failure(viewer_here(test::with(live, {"--points", "x.ply"})), 2, "--source");
  test::expect_failure(
      viewer_here({"--scene", source_file("assets/cube.glb").string(), "--link", "null", "--headless"}), 2, "--source");
  std::ofstream(folder / "bad") << "draw\njump\n";
  test::expect_failure(viewer_here(test::with(live, {"--interact", (folder / "bad").string()})), 4, ":2: ");
}

TEST_F(Viewer, FramesAdvanceTheRunningFocus) {
  const auto folder = test::scratch_folder("viewer-slots");
  const auto arguments = [](const std::vector<std::string>& more) {
    return host_touch(test::with({"--quiet", "--frame", "touch"}, more));
  };
  const auto shot = [&](const std::string& name, const std::vector<std::string>& more) {
    const std::string file = (folder / name).string();
    EXPECT_EQ(viewer_here(test::with(arguments(more), {"--screenshot", file})).exit_code, 0);
    return test::read_text(file);
  };
  const std::string first = shot("1.png", {}), second = shot("2.png", {"--frames", "2"});
  EXPECT_NE(second, first);
  EXPECT_EQ(shot("s.png", {"--slot", "1"}), second);
  const auto filmed = viewer(arguments({"--frames", "11", "--video", (folder / "film").string()}));
  ASSERT_EQ(filmed.exit_code, 0) << filmed.err;
  EXPECT_EQ(test::read_text(folder / "film/000010.png"), first);  // ten foci: one full turn
  EXPECT_EQ(test::read_text(folder / "film/000001.png"), second);
}

TEST_F(Viewer, AVideoIsEveryFrame) {
  const auto folder = test::scratch_folder("viewer-video");
  const std::string video = (folder / "frames").string(), shot = (folder / "last.png").string();
  const auto run = viewer(cube_touch({"--headless", "--frames", "3", "--video", video, "--screenshot", shot}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find(video), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(video), {}), 3);
  const std::string first = test::read_text(folder / "frames/000000.png");
  EXPECT_NE(first, test::read_text(folder / "frames/000001.png"));
  EXPECT_EQ(test::read_text(folder / "frames/000002.png"), test::read_text(shot));
  test::expect_failure(viewer_here(host_touch({"--video", video})), 2, "not empty");
  test::expect_failure(viewer_here(host_touch({"--video", "/no/such/folder"})), 1, "/no/such/folder");
  const std::string live = (folder / "live").string();
  const auto filmed = viewer_here({"--scene", source_file("assets/cube.glb").string(), "--source", "synthetic",
                                   "--noise-free", "--layout", "autd3", "--backend", "cpu", "--headless", "--quiet",
                                   "--size", "320x200", "--frames", "3", "--video", live, "--screenshot", shot});
  ASSERT_EQ(filmed.exit_code, 0) << filmed.err;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(live), {}), 3);
  EXPECT_EQ(test::read_text(folder / "live/000002.png"), test::read_text(shot));
}

TEST_F(Viewer, LayersAreShownAndHidden) {
  const auto folder = test::scratch_folder("viewer-layers");
  const auto shot = [&](const std::string& name, const std::vector<std::string>& more) {
    const std::string file = (folder / name).string();
    EXPECT_EQ(viewer_here(host_touch(test::with({"--quiet", "--screenshot", file}, more))).exit_code, 0);
    return test::read_text(file);
  };
  const std::string usual = shot("usual.png", {}), bare = shot("bare.png", {"--hide", "grid,legend"});
  ASSERT_EQ(
      viewer(host_touch({"--quiet", "--hide", "grid,legend", "--screenshot", (folder / "b.png").string()})).exit_code,
      0);
  EXPECT_EQ(test::read_text(folder / "b.png"), bare);
  EXPECT_NE(shot("sections.png", {"--show", "sections"}), usual);
  EXPECT_NE(bare, usual);
  EXPECT_EQ(shot("none.png", {"--opacity", "grid=0,legend=0"}), bare);
  const auto refused = [&](const std::vector<std::string>& more, const char* part) {
    test::expect_failure(viewer_here(host_touch(more)), 2, part);
  };
  refused({"--hide", "grid,nonsense"}, "'nonsense' is not a layer; give solids");
  refused({"--show", "grid,"}, "--show");
  refused({"--opacity", "solids"}, "--opacity");
  refused({"--opacity", "solids=2"}, "solids=2");
  refused({"--explode", "2"}, "--explode");
}

TEST_F(Viewer, TheFieldOfTheSlotStandsInAPlane) {
  const auto folder = test::scratch_folder("viewer-slice");
  const std::string layout = (folder / "four.toml").string();
  {
    std::ofstream file(layout);
    for (const char* place : {"-0.05, -0.05", "0.05, -0.05", "-0.05, 0.05", "0.05, 0.05"})
      file << "[[transducer]]\nposition_m = [" << place << ", 0]\naxis = [0, 0, 1]\n";
  }
  const auto shot = [&](const std::string& name, const std::vector<std::string>& more) {
    const std::string file = (folder / name).string();
    const std::vector<std::string> all{"--quiet", "--layout", layout,         "--frame", "touch",
                                       "--hide",  "array",    "--screenshot", file};
    EXPECT_EQ(viewer_here(host_touch(test::with(all, more))).exit_code, 0);
    return test::read_text(file);
  };
  const std::string slice = shot("xz.png", {"--slice", "xz", "--slice-size", "20mm"});
  EXPECT_NE(shot("none.png", {}), slice);
  EXPECT_NE(shot("xy.png", {"--slice", "xy", "--slice-size", "20mm"}), slice);
  EXPECT_NE(shot("at.png", {"--slice-at", "0,-1mm,0", "--slice-size", "20mm"}), slice);
  EXPECT_NE(shot("next.png", {"--slice", "xz", "--slice-size", "20mm", "--slot", "1"}), slice);
  const auto whole = viewer(cube_touch({"--headless", "--layout", "autd3", "--slice", "xz", "--screenshot",
                                        (folder / "whole.png").string(), "--quiet"}));
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_EQ(whole.err, "");
  test::expect_failure(viewer_here(host_touch({"--slice", "xz"})), 2, "--slice goes with --layout or --rig");
  test::expect_failure(viewer_here({"--headless", "--layout", "paper", "--slice", "xz"}), 2, "it needs a touch");
}

TEST_F(Viewer, ThePressureOnTheFingerIsHeat) {
  const auto folder = test::scratch_folder("viewer-heat");
  const std::string ball = (folder / "ball.ply").string(), file = (folder / "heat.png").string();
  const geometry::Mesh mesh = geometry::icosphere(6e-3, 7);
  geometry::write_ply(ball, mesh.positions, mesh.triangles);
  const std::vector<std::string> touch{"--scene",       source_file("assets/cube.glb").string(),
                                       "--points",      ball,
                                       "--skin",        ball,
                                       "--penetration", "2mm",
                                       "--size",        "320x200",
                                       "--frame",       "touch",
                                       "--hide",        "array,legend",
                                       "--backend",     "cpu",
                                       "--headless",    "--show",
                                       "heat"};
  const auto run = viewer(test::with(touch, {"--layout", "autd3", "--screenshot", file}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // Almost black where nothing is felt, lightest where most is felt.
  const drawing::Pixels pixels = drawing::read_png(file);
  std::size_t dark = 0, light = 0;
  for (std::uint32_t y = 0; y < pixels.height; ++y) {
    for (std::uint32_t x = 0; x < pixels.width; ++x) {
      dark += pixels.at(x, y)[1] < 40;
      light += pixels.at(x, y)[0] > 200 && pixels.at(x, y)[2] < 120;
    }
  }
  EXPECT_GT(dark, 2000u);
  EXPECT_GT(light, 200u);
  // The rates of its afferents, with the same colours.
  std::vector<std::string> rates(touch.begin(), touch.end() - 2);
  const std::string other = (folder / "rates.png").string();
  for (const char* colour : {"pressure", "PC"}) {
    const auto again = viewer_here(test::with(rates, {"--layout", "autd3", "--heat", colour, "--screenshot", other}));
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(drawing::read_png(other).rgba == pixels.rgba, colour == std::string("pressure")) << colour;
  }
  test::expect_failure(viewer_here(touch), 2, "--show heat goes with --layout or --rig");
  test::expect_failure(viewer_here(host_touch({"--layout", "autd3", "--show", "heat"})), 2, "--skin");
}

TEST_F(Viewer, AParticipantSeesTheObjectWithEitherEye) {
  const auto folder = test::scratch_folder("viewer-participant");
  const std::string scene = source_file("assets/pyramid.glb").string();
  const auto arguments = [&](const std::vector<std::string>& more) {
    return test::with({"--participant", "--scene", scene, "--headless", "--quiet", "--size", "320x180"}, more);
  };
  const auto shot = [&](const std::string& name, const std::vector<std::string>& more) {
    const std::string file = (folder / name).string();
    EXPECT_EQ(viewer_here(test::with(arguments(more), {"--screenshot", file})).exit_code, 0) << name;
    return drawing::read_png(file);
  };
  const drawing::Pixels both = shot("both.png", {"--stereo", "side-by-side"});
  const drawing::Pixels tile = shot("tile.png", {"--stereo", "side-by-side", "--hide", "solids,edges"});
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
  EXPECT_GT(drawing::mean_difference(shot("columns.png", {"--stereo", "columns"}), shot("none.png", {})), 0.002);
  for (const char* stereo : {"side-by-side", "top-bottom"}) {
    const std::string file = (folder / "odd.png").string();
    const std::vector<std::string> line{"--participant", "--scene",  scene,  "--headless",   "--quiet", "--size",
                                        "321x181",       "--stereo", stereo, "--screenshot", file};
    const auto run = stereo == std::string("top-bottom") ? viewer(line) : viewer_here(line);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const drawing::Pixels odd = drawing::read_png(file);
    EXPECT_TRUE(odd.width == 321 && odd.height == 181) << odd.width << "x" << odd.height;
  }
  const auto refused = [&](const std::vector<std::string>& more, int code, const char* part) {
    test::expect_failure(viewer_here(arguments(more)), code, part);
  };
  refused({"--eye", "0,0,-1"}, 2, "not in front of the screen");
  refused({"--stereo", "nonsense"}, 2, "--stereo");
  const std::string rig = (folder / "bare.toml").string();
  std::ofstream(rig) << sensing::to_toml(sensing::Rig{});
  refused({"--screen", rig}, 4, "bare.toml");
  test::expect_failure(viewer_here({"--scene", scene, "--headless", "--stereo", "rows"}), 2, "--participant");
}

TEST_F(Viewer, AScriptThatEndsWhileARunLoadsIsNoSuccess) {
  const auto folder = test::scratch_folder("viewer-script-loading");
  const std::string script = (folder / "script").string(), shot = (folder / "shot.png").string();
  const auto run = [&](const std::string& text, const std::vector<std::string>& more) {
    test::write_text(script, text);
    return viewer(test::with({"--source", "synthetic", "--noise-free", "--layout", "autd3", "--backend", "cpu",
                              "--headless", "--quiet", "--size", "320x200", "--interact", script, "--screenshot", shot},
                             more));
  };
  const std::string cube = source_file("assets/cube.glb").string(), pipe = (folder / "pipe").string();
  test::expect_failure(run("draw\n", {"--scene", (folder / "absent.glb").string()}), 4, "absent.glb");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // nobody ever reads from it
  const auto ended = run("draw\nkey q\n", {"--scene", cube, "--events", pipe});
  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  ASSERT_FALSE(ended.err_lines().empty());
  // On a slow machine, the warning that the pipe has no reader comes first.
  EXPECT_NE(ended.err_lines().back().find("palpa: error: ended while the run was loading"), std::string::npos)
      << ended.err;
  const auto waited = run("draw\n", {"--scene", cube});
  EXPECT_EQ(waited.exit_code, 0) << waited.err;
  const drawing::Pixels shown = drawing::read_png(shot);
  EXPECT_LT(shown.at(160, 120)[0], 250) << "the scene, not an empty picture";
}

TEST_F(Viewer, AScriptThatEndsWhileADroppedFileLoadsSaysWhichPictureIsMissing) {
  const auto folder = test::scratch_folder("viewer-script-dropped");
  const std::string script = (folder / "script").string(), shot = (folder / "shot.png").string();
  const auto run = [&](const std::string& text) {
    test::write_text(script, text);
    return viewer(host_touch({"--quiet", "--interact", script}));
  };
  // It is still loading when the next line is played.
  const geometry::SceneMesh ball{"ball", geometry::icosphere(0.05, test::instrumented() ? 25 : 80)};
  geometry::write_glb(folder / "ball.glb", std::span(&ball, 1));
  const std::string drop = "drop " + (folder / "ball.glb").string() + "\n";
  test::expect_failure(run("draw\nshot " + shot + "\n" + drop + "key q\n"), 1, shot + ": is not written");
  EXPECT_FALSE(std::filesystem::exists(shot));
  // Escape cancels the loading, also before a picture has shown it, and does not end the viewer.
  EXPECT_EQ(run("draw\n" + drop + "key escape\ndraw\nshot " + shot + "\n").exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(shot));
}

TEST_F(Viewer, ARecordingThatIsDroppedOnATouchIsALiveRun) {
  const auto folder = test::scratch_folder("viewer-drop-recording");
  const std::string take = (folder / "take").string(), touch = (folder / "touch.png").string(),
                    live = (folder / "live.png").string(), script = (folder / "script").string();
  const auto recorded = viewer({"--scene", source_file("assets/cube.glb").string(), "--source", "synthetic",
                                "--noise-free", "--backend", "cpu", "--layout", "autd3", "--record", take, "--headless",
                                "--quiet", "--size", "64x48", "--frames", "40"});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  test::write_text(script, "draw\nshot " + touch + "\ndrop " + take + "\ndraw\n");
  const std::vector<std::string> line{"--layout", "autd3",      "--backend", "cpu",        "--hide",
                                      "legend",   "--frame",    "objects",   "--headless", "--screenshot",
                                      live,       "--interact", script};
  const auto dropped = viewer(cube_touch(line));
  EXPECT_EQ(dropped.exit_code, 0) << dropped.err;
  EXPECT_EQ(dropped.err, "");
  EXPECT_GT(drawing::mean_difference(drawing::read_png(touch), drawing::read_png(live)), 1e-4) << "what cameras saw";
  test::write_text(folder / "take" / "times.csv", "no times\n");
  const auto broken = viewer_here(cube_touch(line));
  EXPECT_EQ(broken.exit_code, 0) << broken.err << "the touch stays";
}

TEST_F(Viewer, ComparesWithAReference) {
  const auto folder = test::scratch_folder("viewer-reference");
  const std::string shot = (folder / "p.png").string(), other = (folder / "other.png").string();
  ASSERT_EQ(viewer_here(host_touch({"--screenshot", shot, "--quiet"})).exit_code, 0);
  EXPECT_EQ(viewer_here(host_touch({"--reference", shot, "--threshold", "0", "--quiet"})).exit_code, 0);
  ASSERT_EQ(viewer_here(host_touch({"--screenshot", other, "--quiet", "--dark"})).exit_code, 0);
  test::expect_failure(viewer(host_touch({"--reference", other})), 1, "other.png");
  EXPECT_EQ(viewer_here(host_touch({"--reference", other, "--threshold", "0.99", "--quiet"})).exit_code, 0);
  ASSERT_EQ(viewer_here(host_touch({"--screenshot", other, "--quiet"}, "300x200")).exit_code, 0);
  test::expect_failure(viewer_here(host_touch({"--reference", other})), 4, "300x200");
}

TEST_F(Viewer, DrawsAnArrayAloneAndWithATouch) {
  const auto folder = test::scratch_folder("viewer-array");
  const std::string alone = (folder / "alone.png").string(), driven = (folder / "driven.png").string();
  EXPECT_EQ(viewer_here({"--layout", "sonicsurface", "--headless", "--screenshot", alone, "--quiet"}).exit_code, 0);
  EXPECT_EQ(drawing::read_png(alone).width, 1280u);
  EXPECT_EQ(
      viewer(cube_touch({"--layout", "paper", "--headless", "--screenshot", driven, "--quiet", "--inset"})).exit_code,
      0);
}

TEST_F(Viewer, ReportsAsJson) {
  const auto run = viewer(host_touch({"--frames", "2", "--json", "-"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["width"], 320);
  EXPECT_GT(json["timing_ms"]["frame"].get<double>(), 0);
  EXPECT_GE(json["timing_ms"]["frame_p95"].get<double>(), json["timing_ms"]["frame"].get<double>());
}

TEST_F(Viewer, LooksThroughTheCameraOfThatName) {
  const auto folder = test::scratch_folder("viewer-camera");
  sensing::Camera camera;
  camera.name = "from above";
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 100;
  camera.cx = 31.5;
  camera.cy = 23.5;
  camera.T_world_camera = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0.2, 0, 1}};  // columns: it looks down
  std::ofstream(folder / "camera.toml") << sensing::to_toml(sensing::Rig{"", {camera}, {}, {}});
  sensing::write_png16(folder / "depth.png", 64, 48, std::vector<std::uint16_t>(64 * 48, 199));  // in the cube
  const auto line = [&](const std::string& view, const std::vector<std::string>& more) {
    const std::vector<std::string> all{"--scene",   source_file("assets/cube.glb").string(),
                                       "--camera",  (folder / "camera.toml").string(),
                                       "--depth",   (folder / "depth.png").string(),
                                       "--view",    view,
                                       "--size",    "320x240",
                                       "--backend", "cpu",
                                       "--headless"};
    return test::with(all, more);
  };
  const std::string a = (folder / "a.png").string(), b = (folder / "b.png").string();
  EXPECT_EQ(viewer(line("camera:from above", {"--screenshot", a, "--hide", "legend,grid"})).exit_code, 0);
  EXPECT_EQ(
      viewer_here(line("camera", {"--screenshot", b, "--hide", "legend,grid", "--show", "depth", "--quiet"})).exit_code,
      0);
  EXPECT_EQ(test::read_text(a), test::read_text(b)) << "its own image does not hide what it sees";
  // The cube's top is 40 mm wide and 0.2 m away: 100 pixels in the middle of the picture.
  const drawing::Pixels pixels = drawing::read_png(a);
  EXPECT_GT(pixels.at(110 - 8, 120)[0], 250);
  EXPECT_LT(pixels.at(110 + 8, 120)[0], 240);
  test::expect_failure(viewer_here(line("camera:from below", {})), 2,
                       "unknown camera 'from below'; give one of from above");
}

TEST_F(Viewer, HelpAndVersion) {
  const auto usual = viewer({"--help"}), all = viewer({"--help", "all"});
  EXPECT_EQ(usual.exit_code, 0);
  EXPECT_EQ(all.exit_code, 0);
  for (const char* part : {"--scene", "--headless", "--screenshot", "--layout", "Exit codes"}) {
    EXPECT_NE(usual.out.find(part), std::string::npos) << part;
    EXPECT_NE(all.out.find(part), std::string::npos) << part;
  }
  for (const char* part : {"--delta", "--gpu"}) {
    EXPECT_EQ(usual.out.find(part), std::string::npos) << part;
    EXPECT_NE(all.out.find(part), std::string::npos) << part;
  }
  EXPECT_LE(std::count(usual.out.begin(), usual.out.end(), '\n'), 40);
  EXPECT_EQ(viewer({"--version"}).out.rfind("palpa-viewer ", 0), 0u);
}

TEST_F(Viewer, ValidationIsSilent) {
  if (test::instrumented()) GTEST_SKIP() << "skipped: the layer leaks by itself, which a leak checker would report";
  for (const char* preset : {"core", "sync"}) {
    const auto run =
        viewer(cube_touch({"--headless", "--frames", "3", "--layout", "autd3", "--inset", "--validation", preset}));
    if (run.exit_code == 3 && run.err.find("vulkan-validationlayers") != std::string::npos) GTEST_SKIP() << run.err;
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
}

}  // namespace
}  // namespace palpa
