// The window, on a private X server; skipped if there is none.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <sys/types.h>
#include <unistd.h>
#include <csignal>

#include <filesystem>
#include <fstream>
#include <future>
#include <sstream>
#include <string>
#include <thread>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "drawing/png.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "gpu/device.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/udp_receiver.hpp"
#include "viewer/render/drawing_test.hpp"
#include "x_display.hpp"

namespace palpa {
namespace {

using Window = test::DrawingTest;

using namespace std::chrono_literals;
using test::source_file;

test::Result viewer(const test::XServer& server, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"--scene",       source_file("assets/cube.glb").string(),
                                     "--points",      source_file("assets/finger.ply").string(),
                                     "--penetration", "3mm",
                                     "--size",        "500x400"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const std::string config = test::scratch_folder("window-config");  // for the window's size
  return test::run_program(PALPA_VIEWER_BINARY, arguments,
                           {{{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", config}}});
}

/// With every call checked, if the layer is installed. The layer itself leaks, which a leak checker would report.
std::string validation() {
  return gpu::validation_layer_present() && !test::instrumented() ? "sync" : "off";
}

TEST_F(Window, DrawsFramesAndEnds) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto run = viewer(server, {"--frames", "10", "--layout", "autd3", "--inset", "--validation", validation()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

/// Long enough to draw a picture, and to draw it again finely once it rests.
constexpr auto a_while = test::instrumented() ? 400ms : 250ms;

TEST_F(Window, SurvivesResizingAndHidingAndClosesWhenAsked) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  auto running = std::async(std::launch::async, [&] { return viewer(server, {"--validation", validation()}); });
  test::XHand hand(server.name());
  ASSERT_TRUE(hand.connected());
  ASSERT_TRUE(hand.find("palpa", 60));
  for (const auto& [width, height] :
       {std::pair(700u, 300u), std::pair(64u, 64u), std::pair(1u, 1u), std::pair(640u, 480u)}) {
    std::this_thread::sleep_for(a_while);
    hand.resize(width, height);
  }
  // Many changes of size, faster than frames.
  for (unsigned i = 0; i < 60; ++i) {
    hand.resize(300 + 5 * i, 500 - 5 * i);
    std::this_thread::sleep_for(7ms);
  }
  std::this_thread::sleep_for(a_while);
  hand.iconify();
  std::this_thread::sleep_for(a_while);
  hand.restore();
  std::this_thread::sleep_for(a_while);
  EXPECT_EQ(running.wait_for(0s), std::future_status::timeout) << "ended too early";
  hand.close();
  const auto run = running.get();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

/// For the only child of this process with that name: processor seconds of all its threads so far; below 0 if there is
/// none.
double processor_s_of(const std::string& name) {
  namespace fs = std::filesystem;
  for (const fs::directory_entry& process : fs::directory_iterator("/proc")) {
    std::ifstream status(process.path() / "stat");
    std::string line;
    if (!std::getline(status, line) || line.find("(" + name + ")") == std::string::npos) continue;
    std::istringstream after(line.substr(line.rfind(')') + 1));
    char state = 0;
    pid_t parent = 0;
    if (!(after >> state >> parent) || parent != getpid()) continue;
    double sum = 0;
    for (const fs::directory_entry& thread : fs::directory_iterator(process.path() / "task")) {
      double ran_ns = 0;
      std::ifstream(thread.path() / "schedstat") >> ran_ns;
      sum += ran_ns / 1e9;
    }
    return sum;
  }
  return -1;
}

TEST_F(Window, CostsNothingWhereNothingChangesNorMinimised) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  auto running = std::async(std::launch::async, [&] {
    return test::run_program(PALPA_VIEWER_BINARY,
                             {"--scene", source_file("assets/cube.glb").string(), "--layout", "autd3"},
                             {{{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}}});
  });
  test::XHand hand(server.name());
  ASSERT_TRUE(hand.connected());
  ASSERT_TRUE(hand.find("palpa", 60));
  const auto rests = [] {  // less than a hundredth of a core for half a second, reached soon
    for (int i = 0; i < 60; ++i) {
      const double before = processor_s_of("palpa-viewer");
      std::this_thread::sleep_for(500ms);
      if (before > 0 && processor_s_of("palpa-viewer") - before < 5e-3) return true;
    }
    return false;
  };
  EXPECT_TRUE(rests()) << "unchanged";
  hand.iconify();
  EXPECT_TRUE(rests()) << "minimised";
  hand.close();
  EXPECT_EQ(running.get().exit_code, 0);
}

// At rest, it shows what --headless draws; in motion, quick pictures. With --fine never, it stays quick.
TEST_F(Window, WhatRestsIsDrawnFinely) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-fine");
  const std::vector<std::string> scene{"--scene", source_file("assets/pyramid.glb").string(), "--size", "320x240"};
  const test::RunOptions screen{
      {{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}}};
  const auto drawn = [&](const std::string& fine) {
    const std::string file = (folder / (fine + ".png")).string();
    const auto run = test::run_program(
        PALPA_VIEWER_BINARY, test::with(scene, {"--fine", fine, "--headless", "--quiet", "--screenshot", file}));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const drawing::Pixels pixels = drawing::read_png(file);
    test::XHand::Picture picture{pixels.width, {}};
    for (std::size_t i = 0; i < pixels.rgba.size(); i += 4)
      picture.pixels.push_back(pixels.rgba[i] << 16U | pixels.rgba[i + 1] << 8U | pixels.rgba[i + 2]);
    return picture;
  };
  const test::XHand::Picture fine = drawn("auto"), quick = drawn("never");
  EXPECT_EQ(fine, drawn("always"));
  EXPECT_FALSE(fine == quick);
  const test::XHand stays(server.name());  // a server that loses its last client restarts
  for (const std::string wanted : {"auto", "never"}) {
    auto running = std::async(std::launch::async, [&] {
      return test::run_program(PALPA_VIEWER_BINARY, test::with(scene, {"--fine", wanted, "--no-panels"}), screen);
    });
    test::XHand hand(server.name());
    ASSERT_TRUE(hand.connected());
    ASSERT_TRUE(hand.find("palpa", 60));
    const auto shows = [&](const test::XHand::Picture& picture) {
      for (int i = 0; i < 400; ++i) {
        if (hand.picture() == picture) return true;
        std::this_thread::sleep_for(25ms);
      }
      return false;
    };
    EXPECT_TRUE(shows(wanted == "auto" ? fine : quick)) << wanted;
    std::this_thread::sleep_for(a_while);
    EXPECT_TRUE(hand.picture() == (wanted == "auto" ? fine : quick)) << wanted << ", and stays";
    hand.close();
    EXPECT_EQ(running.get().exit_code, 0);
  }
}

/// A viewer whose array sounds, and the data that arrives from it.
class Sounding {
 public:
  explicit Sounding(const std::string& display)
      : running_(std::async(std::launch::async, [this, display] {
          return test::run_program(
              PALPA_VIEWER_BINARY,
              {"--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--layout", "autd3",
               "--hold", "5s", "--link", "foci:" + receiver_.address(), "--size", "500x400"},
              {{{"DISPLAY", display}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}}});
        })) {}
  /// Waits for the first line with a finger.
  bool heard() {
    last_ = receiver_.next();
    for (int i = 0; i < 2000 && !last_.empty() && !sounds(); ++i)
      last_ = receiver_.next();
    return !last_.empty() && sounds();
  }
  /// Listens until the program ends.
  test::Result end() {
    while (running_.wait_for(10ms) == std::future_status::timeout)
      drain();
    drain();
    return running_.get();
  }
  bool sounds() const { return last_.find("\"fingers\":[]") == std::string::npos; }
  const std::string& last() const { return last_; }

 private:
  void drain() {
    for (std::string line = receiver_.waiting(); !line.empty(); line = receiver_.waiting())
      last_ = std::move(line);
  }

  test::UdpReceiver receiver_{60s};
  std::string last_;
  std::future<test::Result> running_;
};

TEST_F(Window, ClosingItWhileTheArraySoundsLeavesSilence) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  Sounding viewer(server.name());
  test::XHand hand(server.name());
  ASSERT_TRUE(hand.connected());
  ASSERT_TRUE(hand.find("palpa", 60));
  ASSERT_TRUE(viewer.heard()) << "nothing sounds";
  hand.close();
  const auto run = viewer.end();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(viewer.sounds()) << viewer.last();
}

// Xlib calls exit() in a program whose server has gone.
TEST_F(Window, LosingTheServerWhileTheArraySoundsLeavesSilence) {
  test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  Sounding viewer(server.name());
  ASSERT_TRUE(viewer.heard()) << "nothing sounds";
  server.kill();
  const auto run = viewer.end();
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_FALSE(viewer.sounds()) << viewer.last();
}

/// Ends it with Ctrl-C, this long after its window shows something.
void expect_a_clean_end(const char* name, const std::vector<std::string>& more, const std::string& script,
                        const std::string& says, const test::UdpReceiver* link = nullptr) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder(name);
  const std::string said = (folder / "stderr").string();
  const test::Unread err = test::Unread::file(said);
  test::write_text(folder / "script", script);
  std::vector<std::string> arguments{"--scene",
                                     source_file("assets/cube.glb").string(),
                                     "--layout",
                                     "autd3",
                                     "--hold",
                                     "5s",
                                     "--size",
                                     "500x400",
                                     "--source",
                                     "synthetic",
                                     "--noise-free",
                                     "--interact",
                                     (folder / "script").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  test::LiveRun run(
      arguments,
      {.err = &err,
       .environment = {{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}},
       .program = PALPA_VIEWER_BINARY});
  test::XHand hand(server.name());
  ASSERT_TRUE(hand.connected());
  ASSERT_TRUE(hand.find("palpa", 60));
  // What a driver compiles for the first picture is not what is measured here.
  for (int i = 0; i < 3000 && hand.picture().colours() < 20; ++i)
    std::this_thread::sleep_for(20ms);
  for (int i = 0; i < 3000 && test::read_text(said) != says; ++i)
    std::this_thread::sleep_for(20ms);
  if (link) {
    ASSERT_NE(link->next(), "") << "the run continues";
  }
  // The viewer must not be waiting for its next step either: wait until the resting scene has been drawn finely.
  test::XHand::Picture before = hand.picture();
  for (int i = 0, same = 0; i < 80 && same < 10; ++i) {
    std::this_thread::sleep_for(a_while / 5);
    test::XHand::Picture now = hand.picture();
    same = now == before ? same + 1 : 0;
    before = std::move(now);
  }
  run.signal(SIGINT);
  const test::LiveRun::End end = run.wait(30);
  EXPECT_TRUE(end.ended);
  EXPECT_EQ(end.exit_code, 0) << test::read_text(said);
  EXPECT_EQ(test::read_text(said), says);
}

TEST_F(Window, CtrlCEndsItCleanlyWhileTheArrayIsOff) {
  const test::UdpReceiver link(60s);  // patient: a run that is switched off before it sounds sends only its end
  expect_a_clean_end("viewer-off", {"--link", "foci:" + link.address()}, "key o\n", "", &link);
}

TEST_F(Window, CtrlCEndsItCleanlyWhileItLoads) {
  const auto folder = test::scratch_folder("viewer-fifo");
  const std::string pipe = (folder / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // nobody will ever read from it
  expect_a_clean_end("viewer-loading", {"--events", pipe}, "draw\n",
                     "palpa: warning: " + pipe + ": palpa waits for somebody to read this pipe\n");
}

TEST_F(Window, OneWhoseRunFailedEndsAsTheRunDoes) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-failed");
  test::write_text(folder / "log", "draw 2\nwait 0.5\ndraw 2\nkey q\n");
  const auto run =
      test::run_program(PALPA_VIEWER_BINARY,
                        {"--scene", (folder / "absent.glb").string(), "--source", "synthetic", "--size", "300x200",
                         "--interact", (folder / "log").string()},
                        {{{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}}});
  test::expect_failure(run, 4, "absent.glb");
}

TEST_F(Window, PlaysARecordedLogAndEnds) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-log");
  std::ofstream(folder / "log") << "drag 100 100 200 150\nscroll 2\nkey 7\nkey h\nresize 600 300\ndraw 3\nkey escape\n"
                                   "click 400 20\ndrop /nowhere/broken.glb\ndraw 2\nkey tab\nkey tab\nkey q\n";
  const auto run = viewer(server, {"--interact", (folder / "log").string(), "--validation", validation()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST_F(Window, TheParticipantHasAWindowOfItsOwn) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-participant-window");
  for (const char* object : {"cube.glb", "pyramid.glb"})
    std::filesystem::copy_file(source_file("assets") / object, folder / object);
  auto running = std::async(std::launch::async, [&] {
    return test::run_program(PALPA_VIEWER_BINARY,
                             {"--scene", (folder / "cube.glb").string(), "--participant", "--stereo", "side-by-side",
                              "--size", "300x200", "--validation", validation()},
                             {{{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}}});
  });
  test::XHand participant(server.name()), operators(server.name());
  ASSERT_TRUE(participant.connected() && operators.connected());
  ASSERT_TRUE(operators.find("palpa", 60));
  ASSERT_TRUE(participant.find("palpa participant", 60));
  const auto comes_to = [&](const auto& condition) {
    for (int i = 0; i < 3000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  };
  test::XHand::Picture cube, tile, pyramid;
  EXPECT_TRUE(comes_to([&] { return (cube = participant.picture()).colours() > 20; })) << "both eyes' cube";
  EXPECT_EQ(cube.width, 1280u) << "all of the screen";
  participant.press("v");
  EXPECT_TRUE(comes_to([&] { return (tile = participant.picture()).colours() > 1 && tile != cube; }));
  EXPECT_LT(tile.colours(), cube.colours()) << "the tile alone";
  participant.press("v");
  EXPECT_TRUE(comes_to([&] { return participant.picture() == cube; }));
  participant.damage();
  EXPECT_TRUE(comes_to([&] { return participant.picture() == cube; })) << "what was wiped away is drawn again";
  participant.press("Next");
  EXPECT_TRUE(comes_to([&] {
    pyramid = participant.picture();
    return pyramid != cube && pyramid != tile;
  })) << "the next object";
  participant.resize(1279, 717);  // the two halves do not fill it
  EXPECT_TRUE(comes_to([&] {
    const test::XHand::Picture odd = participant.picture();
    return odd.width == 1279 && odd.colours() > 20;
  }));
  participant.press("Escape");
  EXPECT_TRUE(comes_to([&] { return !participant.there(); }));
  EXPECT_EQ(running.wait_for(0s), std::future_status::timeout) << "the other window goes on";
  operators.close();
  const auto run = running.get();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST_F(Window, SoundIsPlayedThroughAndFilmed) {
  const test::XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-sound-log");
  const std::string ball = (folder / "ball.ply").string();
  const geometry::Mesh mesh = geometry::icosphere(6e-3, 6);
  geometry::write_ply(ball, mesh.positions, mesh.triangles);
  test::write_text(folder / "log",
                   "draw 2\nkey 7\ndrag 150 200 250 220\nresize 700 300\ndraw 2\nresize 64 64\ndraw\nresize 1 1\n"
                   "draw\nresize 640 480\nwait 0.5\nkey 3\ndrag 200 240 260 200\nkey tab\ndraw 2\nkey q\n");
  const auto run =
      test::run_program(PALPA_VIEWER_BINARY, {"--scene",       source_file("assets/cube.glb").string(),
                                              "--points",      source_file("assets/finger.ply").string(),
                                              "--penetration", "3mm",
                                              "--skin",        ball,
                                              "--layout",      "autd3",
                                              "--show",        "heat,slice,sections",
                                              "--size",        "500x400",
                                              "--video",       (folder / "film").string(),
                                              "--interact",    (folder / "log").string(),
                                              "--validation",  validation()},
                        {{{"DISPLAY", server.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", folder.string()}}});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "") << "the layers were silent";
  bool resized = false;
  for (const auto& file : std::filesystem::directory_iterator(folder / "film"))
    resized = resized || drawing::read_png(file.path()).width == 640;
  EXPECT_TRUE(resized);
}

TEST_F(Window, AServerThatIsNotThereIsNoDisplay) {
  const auto run =
      test::run_program(PALPA_VIEWER_BINARY, {"--layout", "autd3"}, {{{"DISPLAY", ":4711"}, {"WAYLAND_DISPLAY", ""}}});
  test::expect_failure(run, 3, "--headless");
}

}  // namespace
}  // namespace palpa
