// The window's frame: title, size, place and scale; skipped if there is no X server.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cli/support/process.hpp"
#include "drawing/png.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/render/drawing_test.hpp"
#include "x_display.hpp"

namespace palpa {
namespace {

using WindowFrame = test::DrawingTest;

using namespace std::chrono_literals;
using test::source_file;

/// A viewer on a private display, until it is closed.
class Shown {
 public:
  Shown(const std::vector<std::string>& words, const test::Environment& more) : hand_(server_.name()) {
    test::Environment environment{
        {"DISPLAY", server_.name()}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}};
    for (const auto& [name, value] : more) {
      std::erase_if(environment, [&, key = name](const auto& one) { return one.first == key; });
      environment.emplace_back(name, value);
    }
    running_ = std::async(std::launch::async,
                          [=] { return test::run_program(PALPA_VIEWER_BINARY, words, {.environment = environment}); });
  }
  test::XHand& hand() { return hand_; }
  bool comes_to(const std::function<bool()>& condition) {
    for (int i = 0; i < 1500; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  }
  test::Result close() {
    hand_.close();
    return running_.get();
  }

 private:
  test::XServer server_;
  test::XHand hand_;
  std::future<test::Result> running_;
};

bool has_display() {
  static const bool there = !test::XServer().name().empty();
  return there;
}

TEST_F(WindowFrame, TheTitleSaysWhatIsShownAndHow) {
  if (!has_display()) GTEST_SKIP() << "skipped: no Xvfb";
  Shown viewer({"--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--size", "300x200"}, {});
  EXPECT_TRUE(viewer.hand().find("palpa: cube.glb, live (synthetic)", 60));
  const auto run = viewer.close();
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(WindowFrame, EverythingIsEnlargedAsGtkProgramsAre) {
  if (!has_display()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-scale");
  const std::string file = (folder / "large.png").string();
  const std::vector<std::string> scene{"--scene", source_file("assets/pyramid.glb").string(), "--size", "320x240"};
  const auto headless = test::run_program(
      PALPA_VIEWER_BINARY, test::with(scene, {"--headless", "--quiet", "--pixel-ratio", "2", "--screenshot", file}));
  ASSERT_EQ(headless.exit_code, 0) << headless.err;
  const drawing::Pixels pixels = drawing::read_png(file);
  test::XHand::Picture wanted{pixels.width, {}};
  for (std::size_t i = 0; i < pixels.rgba.size(); i += 4)
    wanted.pixels.push_back(pixels.rgba[i] << 16U | pixels.rgba[i + 1] << 8U | pixels.rgba[i + 2]);
  Shown viewer(test::with(scene, {"--no-panels", "--fine", "always"}), {{"GDK_SCALE", "2"}});
  ASSERT_TRUE(viewer.hand().find("palpa", 60));
  EXPECT_TRUE(viewer.comes_to([&] { return viewer.hand().picture() == wanted; }));
  EXPECT_EQ(viewer.close().exit_code, 0);
}

TEST_F(WindowFrame, ItIsNoLargerThanTheMonitor) {
  if (!has_display()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-window-fits");
  Shown viewer({"--scene", source_file("assets/cube.glb").string()},
               {{"XDG_CONFIG_HOME", folder.string()}, {"GDK_SCALE", "4"}});
  ASSERT_TRUE(viewer.hand().find("palpa", 60));
  EXPECT_TRUE(viewer.comes_to([&] {
    const test::XHand::Picture seen = viewer.hand().picture();
    return seen.width == 1280 && seen.pixels.size() == std::size_t{1280} * 720;
  })) << "the size of the screen";
  EXPECT_EQ(viewer.close().exit_code, 0);
}

TEST_F(WindowFrame, TheSizeIsRememberedWithoutOneOnTheLine) {
  if (!has_display()) GTEST_SKIP() << "skipped: no Xvfb";
  const auto folder = test::scratch_folder("viewer-window-size");
  std::filesystem::create_directory(folder / "palpa");
  const auto settings = folder / "palpa" / "viewer.toml";
  test::write_text(settings, "[window]\nx = 30\ny = 20\nwidth = 410\nheight = 310\n");
  const std::vector<std::string> scene{"--scene", source_file("assets/cube.glb").string()};
  Shown viewer(scene, {{"XDG_CONFIG_HOME", folder.string()}});
  ASSERT_TRUE(viewer.hand().find("palpa", 60));
  EXPECT_TRUE(viewer.comes_to([&] { return viewer.hand().picture().width == 410; }));
  viewer.hand().resize(432, 321);
  EXPECT_TRUE(viewer.comes_to([&] { return viewer.hand().picture().width == 432; }));
  std::this_thread::sleep_for(300ms);
  const auto run = viewer.close();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(test::read_text(settings).find("width = 432"), std::string::npos) << test::read_text(settings);
}

}  // namespace
}  // namespace palpa
