// The viewer without its window, and how a live run begins, ends and begins anew in it.
#include "viewer/app.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "heard_link.hpp"
#include "support/shared_data.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class LiveApp : public testing::Test {
 protected:
  LiveApp() : folder_(test::scratch_folder("viewer-app")), scene_(folder_ / "cube.glb"), other_(folder_ / "other.glb") {
    fs::copy_file(test::source_file("assets/cube.glb"), scene_);
    fs::copy_file(scene_, other_);
    ViewerOptions options;
    options.input.scene = scene_;
    options.given = {{"--scene", {scene_}},   {"--gltf-scene", {"0"}}, {"--source", {"synthetic"}},
                     {"--layout", {"autd3"}}, {"--backend", {"cpu"}},  {"--noise-free", {}},
                     {"--hold", {"5s"}},      {"--link", {"heard"}}};
    Surroundings around;
    around.kinds.links.push_back(test::heard_link(heard_));
    around.stop = &stop_;
    around.panels = false;
    app_ = std::make_unique<App>(options, size_, std::move(around));
  }

  /// Goes round, a tenth of a second of the application's clock each time.
  template <typename Condition>
  bool goes_round_until(Condition condition) {
    const auto until = std::chrono::steady_clock::now() + 60s;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > until) return false;
      go_round();
      std::this_thread::sleep_for(2ms);
    }
    return true;
  }
  void go_round(int times = 1) {
    for (int i = 0; i < times; ++i)
      app_->advance(now_s_ += 0.1, size_);
  }
  bool comes_to(LiveState state) {
    return goes_round_until([&] { return app_->desk().live_state == state; });
  }
  /// For seconds of its clock: and it would have begun at once.
  bool stays_off() {
    go_round(50);
    return app_->desk().live_state == LiveState::ended && stop_;
  }
  void all_off() {
    WindowEvent event;
    event.kind = WindowEvent::Kind::key;
    event.key = key_of('o');
    app_->handle(event, size_);
  }
  void drop(const fs::path& file) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::drop;
    event.text = file;
    app_->handle(event, size_);
  }
  static void write_anew(const fs::path& file) { fs::last_write_time(file, fs::last_write_time(file) + 1s); }
  const setup::Given& given() const { return app_->desk().given; }

  const Size size_{400, 300};
  fs::path folder_, scene_, other_;
  std::shared_ptr<test::Heard> heard_ = std::make_shared<test::Heard>();
  std::atomic<bool> stop_{false};
  double now_s_ = 0;
  std::unique_ptr<App> app_;
};

TEST_F(LiveApp, AllOffLastsWhateverChanges) {
  ASSERT_TRUE(goes_round_until([&] { return heard_->sounded(); }));
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
  EXPECT_FALSE(heard_->last_sounds);
  write_anew(scene_);
  EXPECT_TRUE(stays_off()) << "the scene was written anew";
  drop(other_);
  EXPECT_TRUE(stays_off()) << "another scene";
  EXPECT_EQ(given().at("--scene").front(), other_) << "is what Start begins";
}

TEST_F(LiveApp, AllOffWinsOverARestart) {
  ASSERT_TRUE(comes_to(LiveState::running));
  drop(other_);
  go_round();  // the restart is pending: its run has not ended yet, or has just begun
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
}

TEST_F(LiveApp, AllOffWinsOverWhatIsAskedForWithIt) {
  ASSERT_TRUE(comes_to(LiveState::running));
  drop(other_);
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
}

TEST_F(LiveApp, ASceneThatIsWrittenAnewBeginsAnewAndKeepsItsOptions) {
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(11);
  write_anew(scene_);
  ASSERT_TRUE(comes_to(LiveState::loading));
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_TRUE(given().contains("--gltf-scene"));
}

TEST_F(LiveApp, AnotherSceneIsNotOneThatWasWrittenAnew) {
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(11);
  write_anew(other_);
  drop(other_);
  EXPECT_FALSE(given().contains("--gltf-scene")) << "that was of the one before";
  ASSERT_TRUE(comes_to(LiveState::loading));
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(50);
  EXPECT_EQ(app_->desk().live_state, LiveState::running);
}

}  // namespace
}  // namespace palpa::viewer
