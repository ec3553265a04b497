// The viewer without its window, with a live run that it looks at.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "support/shared_data.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/heard_link.hpp"

namespace palpa::viewer {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class LiveApp : public testing::Test {
 protected:
  explicit LiveApp(bool panels = false, const Size& size = {400, 300})
      : panels_(panels),
        size_(size),
        folder_(test::scratch_folder("viewer-app")),
        scene_(folder_ / "cube.glb"),
        other_(folder_ / "other.glb") {
    fs::copy_file(test::source_file("assets/cube.glb"), scene_);
    fs::copy_file(scene_, other_);
    begin("synthetic");
  }
  void begin(const std::string& source, const std::string& shown = {}) {
    app_.reset();
    heard_ = std::make_shared<test::Heard>();
    ViewerOptions options;
    options.input.scene = scene_;
    options.shown = shown;
    options.given = {{"--scene", {scene_}},  {"--gltf-scene", {"0"}}, {"--source", {source}}, {"--layout", {"autd3"}},
                     {"--backend", {"cpu"}}, {"--noise-free", {}},    {"--hold", {"5s"}},     {"--link", {"heard"}}};
    make(options);
  }
  void make(const ViewerOptions& options) {
    app_.reset();
    AppHost host;
    host.kinds.links.push_back(test::heard_link(heard_));
    host.stop = &stop_;
    host.panels = panels_;
    host.copy = [this](const std::string& text) { copied_ = text; };
    host.goes_live = [this] { ++went_live_; };
    app_ = std::make_unique<App>(options, size_, std::move(host));
  }

  /// Runs the loop, with steps of a tenth of a second of the application's clock.
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
    return goes_round_until([&] { return app_->data().content.run.state == state; });
  }
  /// For seconds of its clock; otherwise it would have started at once.
  bool stays_off() {
    go_round(50);
    return app_->data().content.run.state == LiveState::ended && stop_;
  }
  void key(char character, bool down = true, bool ctrl = false) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::key;
    event.key = key_of(character);
    event.down = down;
    event.ctrl = ctrl;
    app_->handle(event, size_);
  }
  void key(Key named) { key(static_cast<char>(named)); }
  void copy_run() { key('c', true, true); }
  /// Whether one of the lines that are shown has this text in it.
  bool says(const std::string& text) const {
    return std::ranges::any_of(app_->data().messages.toasts(),
                               [&](const Toast& toast) { return toast.text.find(text) != std::string::npos; });
  }
  /// The same of the lines that were ever shown.
  bool has_said(const std::string& text) const {
    return std::ranges::any_of(app_->data().messages.log(),
                               [&](const log::Line& line) { return line.text.find(text) != std::string::npos; });
  }
  void all_off() { key('o'); }
  void point_at(const Vec3& world) {
    const Projected at = project(projection(app_->data().state.viewpoint, size_.width, size_.height), world);
    WindowEvent event;
    event.kind = WindowEvent::Kind::move;
    event.x = at.x, event.y = at.y;
    app_->handle(event, size_);
  }
  void drop(const fs::path& file) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::drop;
    event.text = file;
    app_->handle(event, size_);
  }
  void button(WindowEvent::Kind kind, double x, double y) {
    WindowEvent event;
    event.kind = kind;
    event.x = x;
    event.y = y;
    app_->handle(event, size_);
  }
  /// Frames of a finger in the cube.
  fs::path recording() {
    const fs::path folder = folder_ / "take";
    if (fs::exists(folder)) return folder;
    setup::LiveOptions options;
    options.scene = scene_;
    options.frames = 30;
    options.record = folder;
    options.common.backend = setup::Backend::cpu;
    options.noise_free = options.every_frame = true;
    std::atomic<bool> stop{false};
    setup::LiveRun(options, {}, {}, stop).run();
    return folder;
  }
  bool opens_other() {
    return goes_round_until([&] { return options().scene == other_; });
  }
  static void write_again(const fs::path& file) { fs::last_write_time(file, fs::last_write_time(file) + 1s); }
  const setup::LiveOptions& options() const { return app_->data().content.edit.options(); }

  const bool panels_;
  const Size size_;
  fs::path folder_, scene_, other_;
  std::shared_ptr<test::Heard> heard_ = std::make_shared<test::Heard>();
  std::atomic<bool> stop_{false};
  double now_s_ = 0;
  int went_live_ = 0;
  std::string copied_;
  std::unique_ptr<App> app_;
};

/// With panels, and a hand that operates them.
class LiveAppWithPanels : public LiveApp {
 protected:
  explicit LiveAppWithPanels(const Size& size = {400, 300}) : LiveApp(true, size) {}

  void draw(int pictures = 3) {
    for (int i = 0; i < pictures; ++i) {
      go_round();
      app_->render(size_, 1, now_s_);
    }
  }
  /// Where the widget is, after a picture has shown it.
  std::optional<Area> place_of_widget(const std::string& name) {
    draw();
    const auto& named = app_->data().places.named;
    const auto found = named.find(name);
    return found == named.end() ? std::nullopt : std::optional(found->second);
  }
  void click_at(double x, double y) {
    button(WindowEvent::Kind::move, x, y);
    draw();
    button(WindowEvent::Kind::press, x, y);
    draw(1);
    button(WindowEvent::Kind::release, x, y);
    draw();
  }
  void click(const Area& area) { click_at((area.left + area.right) / 2, (area.top + area.bottom) / 2); }
  void click(const std::string& name) {
    const std::optional<Area> area = place_of_widget(name);
    ASSERT_TRUE(area) << name;
    click(*area);
  }
  void type(const std::string& text) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::text;
    event.text = text;
    app_->handle(event, size_);
    draw();
    key(Key::enter);
    draw();
    key(static_cast<char>(Key::enter), false);
    draw();
  }
  Area all_off_button() { return app_->data().places.all_off.value_or(Area()); }
};

}  // namespace palpa::viewer
