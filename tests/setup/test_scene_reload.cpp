// A scene that is saved while it runs. tests/python/test_live_control.py has the command.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "geometry/gltf/gltf.hpp"
#include "session/stepped_clock.hpp"
#include "setup/sessions/scene_reload.hpp"
#include "support/begins.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::setup {
namespace {

/// A session of a cube, whose name is what the file says.
std::unique_ptr<session::Session> session_of(const std::filesystem::path& file) {
  const std::string text = test::read_text(file);
  if (text.empty() || text == "broken") throw bad_input(file.string(), "is broken");
  auto solids = geometry::make_solids(geometry::load_gltf(test::source_file("assets/cube.glb")));
  solids[0].name = text;
  return std::make_unique<session::Session>(session::SessionSetting{.solids = solids});
}

struct SceneReloadTest : testing::Test {
  std::filesystem::path file = test::scratch_folder("scene_reload") / "scene.glb";
  std::atomic<int> loads{0};
  std::unique_ptr<session::Session> running;
  std::unique_ptr<SceneReload> reload;

  void SetUp() override {
    test::write_text(file, "first");
    running = session_of(file);
    start(session::real_clock());
  }
  void start(const session::Clock& clock) {
    const auto load = [this] {
      ++loads;
      return session_of(file);
    };
    reload = std::make_unique<SceneReload>(file.string(), look_at_scene(file.string()), load, clock);
  }
  /// Replaces the file at once, as many editors do.
  void save(const std::string& text) {
    test::write_text(file.string() + ".new", text);
    std::filesystem::rename(file.string() + ".new", file);
  }
  /// As the loop does between two frames.
  bool has(const std::string& name) {
    if (reload->ready()) reload->take(*running);
    return running->solid_names() == std::vector<std::string>{name};
  }
};

TEST_F(SceneReloadTest, EverySavedSceneReplacesTheOneBefore) {
  for (const char* name : {"second", "the third", "4"}) {
    test::write_text(file, name);
    EXPECT_TRUE(test::begins([&] { return has(name); }));
  }
  save("fifth");
  EXPECT_TRUE(test::begins([&] { return has("fifth"); }));
  EXPECT_EQ(reload->end().taken, 4U);
  EXPECT_FALSE(reload->ready());
}

TEST_F(SceneReloadTest, OneThatTheLoopHasNotTakenIsReplaced) {
  save("second");
  EXPECT_TRUE(test::begins([&] { return reload->ready(); }));
  save("the third");
  EXPECT_TRUE(test::begins([&] { return loads == 2; }));
  EXPECT_TRUE(test::begins([&] { return has("the third"); }));
}

TEST_F(SceneReloadTest, ABrokenOrMissingOneChangesNothingAndIsToldEachTime) {
  const std::string told = test::stderr_of([&] {
    save("broken");
    EXPECT_TRUE(test::begins([&] { return reload->refused() == 1; }));
    std::filesystem::remove(file);
    EXPECT_TRUE(test::begins([&] { return reload->refused() == 2; }));
    save("broken");
    EXPECT_TRUE(test::begins([&] { return reload->refused() == 3; }));
    save("good again");
    EXPECT_TRUE(test::begins([&] { return has("good again"); }));
    const session::ReloadStats stats = reload->end();
    EXPECT_EQ(stats.taken, 1U);
    EXPECT_EQ(stats.refused, 3U);
    EXPECT_EQ(loads, 4);
  });
  const std::string broken =
      "palpa: warning: --reload: palpa keeps the previous scene: " + file.string() + ": is broken\n";
  EXPECT_TRUE(told.starts_with(broken)) << told;
  EXPECT_TRUE(told.ends_with(broken)) << told;
  EXPECT_EQ(std::ranges::count(told, '\n'), 3) << told;
}

TEST_F(SceneReloadTest, AFileThatNobodySavesIsNotRead) {
  const test::SteppedClock clock;
  start(clock);
  test::write_text(file.string() + ".other", "other");
  clock.sleep(10);
  EXPECT_TRUE(has("first"));
  EXPECT_EQ(loads, 0);
  save("second");
  clock.sleep(10);
  EXPECT_TRUE(has("second"));
  reload.reset();
}

}  // namespace
}  // namespace palpa::setup
