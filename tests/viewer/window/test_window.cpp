// The window: what only a display, a person at it and signals can show.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <sys/types.h>
#include <unistd.h>
#include <csignal>

#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cli/support/live_run.hpp"
#include "drawing/png.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "gpu/device.hpp"
#include "screen_test.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/occurrences.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Line = std::vector<std::string>;

/// With every call checked, if the layer is installed. The layer itself leaks, which a leak checker would report.
std::string validation() {
  return gpu::validation_layer_present() && !instrumented() ? "sync" : "off";
}

/// Long enough to draw a picture, and to draw it again finely once it rests.
constexpr auto a_while = instrumented() ? 400ms : 250ms;

/// A viewer on the server, until it is closed.
class Window : public ScreenTest {
 protected:
  Result run(const Line& words) const { return run_program(PALPA_VIEWER_BINARY, words, {on_screen()}); }
  /// Opens it and waits for its window, which has that title.
  bool opens(const Line& words, const std::string& config = "", const std::string& scale = "1",
             const std::string& title = "palpa") {
    running_ = std::async(std::launch::async, [words, environment = on_screen(config, scale)] {
      return run_program(PALPA_VIEWER_BINARY, words, {environment});
    });
    hand_.emplace(server_->name());
    return hand_->connected() && hand_->find(title, 60);
  }
  bool is_open() const { return running_.wait_for(0s) == std::future_status::timeout; }
  /// As a user does. It must end well. Returns what it has said.
  std::string close() {
    hand_->close();
    const Result result = succeeded(running_.get());
    return result.err;
  }
  /// What a line draws without a window.
  XHand::Picture drawn(const Line& words) const {
    const std::string file = (folder_ / "drawn.png").string();
    succeeded(run_program(PALPA_VIEWER_BINARY, with(words, {"--headless", "--quiet", "--screenshot", file})));
    const drawing::Pixels pixels = drawing::read_png(file);
    XHand::Picture picture{pixels.width, {}};
    for (std::size_t i = 0; i < pixels.rgba.size(); i += 4)
      picture.pixels.push_back(pixels.rgba[i] << 16U | pixels.rgba[i + 1] << 8U | pixels.rgba[i + 2]);
    return picture;
  }
  /// A live run whose array sounds, and what arrives from it.
  bool opens_and_sounds() {
    const Line line = with({"--scene", cube_, "--source", "synthetic", "--layout", "autd3", "--hold", "5s"},
                           {"--size", "500x400", "--link", "foci:" + receiver_.address()});
    if (!opens(line, "", "1", "palpa: cube.glb, live (synthetic)")) return false;
    last_ = receiver_.next();
    for (int i = 0; i < 2000 && !last_.empty() && !sounds(); ++i)
      last_ = receiver_.next();
    return !last_.empty() && sounds();
  }
  /// Listens until the program ends.
  Result end() {
    const auto drain = [&] {
      for (std::string line = receiver_.waiting(); !line.empty(); line = receiver_.waiting())
        last_ = std::move(line);
    };
    while (running_.wait_for(10ms) == std::future_status::timeout)
      drain();
    drain();
    return running_.get();
  }
  bool sounds() const { return last_.find("\"fingers\":[]") == std::string::npos; }
  /// Ends it with Ctrl-C while it waits for nothing but a person.
  void expect_a_clean_end(
      const Line& more, const std::string& script, const std::string& says,
      const std::function<bool()>& went_on = [] { return true; }) {
    const std::string said = (folder_ / "stderr").string();
    const Unread err = Unread::file(said);
    write_text(folder_ / "script", script);
    LiveRun live(with({"--scene", cube_, "--layout", "autd3", "--hold", "5s", "--size", "500x400", "--source",
                       "synthetic", "--noise-free", "--interact", (folder_ / "script").string()},
                      more),
                 {.err = &err, .environment = on_screen(), .program = PALPA_VIEWER_BINARY});
    XHand hand(server_->name());
    ASSERT_TRUE(hand.connected() && hand.find("palpa", 60));
    // What a driver compiles for the first picture is not what is measured here.
    EXPECT_TRUE(comes_to([&] { return hand.picture().colours() >= 20; }));
    EXPECT_TRUE(comes_to([&] { return read_text(said) == says; }));
    ASSERT_TRUE(went_on());
    // It must not be waiting for its next step either: wait until the resting scene has been drawn finely.
    XHand::Picture before = hand.picture();
    for (int i = 0, same = 0; i < 80 && same < 10; ++i) {
      std::this_thread::sleep_for(a_while / 5);
      XHand::Picture now = hand.picture();
      same = now == before ? same + 1 : 0;
      before = std::move(now);
    }
    live.signal(SIGINT);
    const LiveRun::End end = live.wait(60);
    EXPECT_TRUE(end.ended);
    EXPECT_EQ(end.exit_code, 0) << read_text(said);
    EXPECT_EQ(read_text(said), says);
  }

  const fs::path folder_ = scratch_folder("viewer-window");
  const std::string cube_ = source_file("assets/cube.glb").string();
  const std::string finger_ = source_file("assets/finger.ply").string();
  const Line touch_ = with({"--scene", cube_, "--points", finger_, "--penetration", "3mm"},
                           {"--size", "500x400", "--layout", "autd3", "--validation", validation()});
  UdpReceiver receiver_{60s};
  std::string last_;  ///< that the receiver has got
  std::optional<XHand> hand_;
  std::future<Result> running_;
};

TEST_F(Window, DrawsFramesAndEnds) {
  const Result result = succeeded(run(with(touch_, {"--frames", "10", "--inset"})));
  EXPECT_EQ(result.err, "");
}

TEST_F(Window, SurvivesResizingAndHidingAndClosesWhenAsked) {
  ASSERT_TRUE(opens(touch_));
  const auto pauses = [] { std::this_thread::sleep_for(a_while); };  // as a hand does
  for (const auto& [width, height] :
       {std::pair(700u, 300u), std::pair(64u, 64u), std::pair(1u, 1u), std::pair(640u, 480u)}) {
    pauses();
    hand_->resize(width, height);
  }
  // Many changes of size, faster than frames.
  for (unsigned i = 0; i < 60; ++i) {
    hand_->resize(300 + 5 * i, 500 - 5 * i);
    std::this_thread::sleep_for(7ms);
  }
  pauses();
  hand_->iconify();
  pauses();
  hand_->restore();
  pauses();
  EXPECT_TRUE(is_open()) << "ended too early";
  EXPECT_EQ(close(), "");
}

/// For the only child of this process with that name: processor seconds of all its threads so far; below 0 if there is
/// none.
double processor_s_of(const std::string& name) {
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
  ASSERT_TRUE(opens({"--scene", cube_, "--layout", "autd3"}));
  const auto rests = [] {  // less than a hundredth of a core for half a second, reached soon
    for (int i = 0; i < 60; ++i) {
      const double before = processor_s_of("palpa-viewer");
      std::this_thread::sleep_for(500ms);
      if (before > 0 && processor_s_of("palpa-viewer") - before < 5e-3) return true;
    }
    return false;
  };
  EXPECT_TRUE(rests()) << "unchanged";
  hand_->iconify();
  EXPECT_TRUE(rests()) << "minimised";
  close();
}

/// At rest, it shows what --headless draws; with --fine never, it stays quick. Like GTK programs, it is enlarged.
TEST_F(Window, WhatRestsIsDrawnFinelyAndAsLargeAsGtkProgramsAre) {
  const Line scene{"--scene", source_file("assets/pyramid.glb").string(), "--size", "320x240"};
  const XHand::Picture fine = drawn(with(scene, {"--fine", "auto"})), quick = drawn(with(scene, {"--fine", "never"}));
  EXPECT_EQ(fine, drawn(with(scene, {"--fine", "always"})));
  EXPECT_FALSE(fine == quick);
  const XHand stays(server_->name());  // a server that loses its last client restarts
  const XHand::Picture enlarged = drawn(with(scene, {"--pixel-ratio", "2"}));
  for (const auto& [wanted, scale, picture] :
       {std::tuple("auto", "1", &fine), {"never", "1", &quick}, {"always", "2", &enlarged}}) {
    ASSERT_TRUE(opens(with(scene, {"--fine", wanted, "--no-panels"}), "", scale)) << wanted;
    EXPECT_TRUE(comes_to([&, picture = picture] { return hand_->picture() == *picture; })) << wanted;
    std::this_thread::sleep_for(a_while);
    EXPECT_TRUE(hand_->picture() == *picture) << wanted << ", and stays";
    close();
  }
}

TEST_F(Window, ClosingItWhileTheArraySoundsLeavesSilence) {
  ASSERT_TRUE(opens_and_sounds());
  hand_->close();
  succeeded(end());
  EXPECT_FALSE(sounds()) << last_;
}

// Xlib calls exit() in a program whose server has gone.
TEST_F(Window, LosingTheServerWhileTheArraySoundsLeavesSilence) {
  ASSERT_TRUE(opens_and_sounds());
  hand_.reset();  // it is a client of that server, too
  server_->kill();
  const Result result = end();
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_FALSE(sounds()) << last_;
}

TEST_F(Window, CtrlCEndsItCleanlyWhileTheArrayIsOff) {
  // A run that is switched off before it sounds sends only its end.
  expect_a_clean_end({"--link", "foci:" + receiver_.address()}, "key o\n", "", [&] { return receiver_.next() != ""; });
}

TEST_F(Window, CtrlCEndsItCleanlyWhileItLoads) {
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // nobody will ever read from it
  expect_a_clean_end({"--events", pipe}, "draw\n",
                     "palpa: warning: " + pipe + ": palpa waits for somebody to read this pipe\n");
}

TEST_F(Window, OneWhoseRunFailedEndsAsTheRunDoes) {
  write_text(folder_ / "log", "draw 2\nwait 0.5\ndraw 2\nkey q\n");
  expect_failure(run({"--scene", (folder_ / "absent.glb").string(), "--source", "synthetic", "--size", "300x200",
                      "--interact", (folder_ / "log").string()}),
                 4, "absent.glb");
}

TEST_F(Window, AScriptWithSoundIsPlayedThroughAndFilmed) {
  const std::string ball = (folder_ / "ball.ply").string(), film = (folder_ / "film").string();
  const geometry::Mesh mesh = geometry::icosphere(6e-3, 6);
  geometry::write_ply(ball, mesh.positions, mesh.triangles);
  write_text(folder_ / "log",
             "draw 2\ndrag 100 100 200 150\nscroll 2\nkey 7\nkey h\nresize 600 300\ndraw 3\nkey escape\nclick 400 20\n"
             "drop /nowhere/broken.glb\ndraw 2\nkey tab\nkey tab\ndrag 150 200 250 220\nresize 64 64\ndraw\n"
             "resize 1 1\ndraw\nresize 640 480\nwait 0.5\nkey 3\ndrag 200 240 260 200\nkey tab\ndraw 2\nkey q\n");
  const Result result = succeeded(run(with(touch_, {"--skin", ball, "--show", "heat,slice,sections", "--video", film,
                                                    "--interact", (folder_ / "log").string()})));
  EXPECT_CONTAINS(result.err, "ball.ply is not the surface of --points");
  EXPECT_EQ(occurrences(result.err, "\n"), 1u) << "the layers were silent: " << result.err;
  bool resized = false;
  for (const auto& file : fs::directory_iterator(film))
    resized = resized || drawing::read_png(file.path()).width == 640;
  EXPECT_TRUE(resized);
}

TEST_F(Window, TheParticipantHasAWindowOfItsOwn) {
  for (const char* object : {"cube.glb", "pyramid.glb"})
    fs::copy_file(source_file("assets") / object, folder_ / object);
  ASSERT_TRUE(opens({"--scene", (folder_ / "cube.glb").string(), "--participant", "--stereo", "side-by-side", "--size",
                     "300x200", "--validation", validation()}));
  XHand participant(server_->name());
  ASSERT_TRUE(participant.connected() && participant.find("palpa participant", 60));
  XHand::Picture cube, tile, pyramid;
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
    const XHand::Picture odd = participant.picture();
    return odd.width == 1279 && odd.colours() > 20;
  }));
  participant.press("Escape");
  EXPECT_TRUE(comes_to([&] { return !participant.there(); }));
  EXPECT_TRUE(is_open()) << "the other window goes on";
  EXPECT_EQ(close(), "");
}

TEST_F(Window, ItIsNoLargerThanTheMonitor) {
  ASSERT_TRUE(opens({"--scene", cube_}, folder_.string(), "4"));
  EXPECT_TRUE(comes_to([&] {
    const XHand::Picture seen = hand_->picture();
    return seen.width == 1280 && seen.pixels.size() == std::size_t{1280} * 720;
  })) << "the size of the screen";
  close();
}

TEST_F(Window, TheSizeIsRememberedWithoutOneOnTheLine) {
  fs::create_directory(folder_ / "palpa");
  const auto settings = folder_ / "palpa" / "viewer.toml";
  write_text(settings, "[window]\nx = 30\ny = 20\nwidth = 410\nheight = 310\n");
  ASSERT_TRUE(opens({"--scene", cube_}, folder_.string()));
  EXPECT_TRUE(comes_to([&] { return hand_->picture().width == 410; }));
  hand_->resize(432, 321);
  EXPECT_TRUE(comes_to([&] {
    const XHand::Picture seen = hand_->picture();
    return seen.width == 432 && seen.pixels.back() != 0;
  })) << "it has been drawn up to its new corner";
  close();
  EXPECT_NE(read_text(settings).find("width = 432"), std::string::npos) << read_text(settings);
}

TEST(Display, AServerThatIsNotThereIsRefused) {
  expect_failure(
      run_program(PALPA_VIEWER_BINARY, {"--layout", "autd3"}, {{{"DISPLAY", ":4711"}, {"WAYLAND_DISPLAY", ""}}}), 3,
      "--headless");
}

}  // namespace
}  // namespace palpa::test
