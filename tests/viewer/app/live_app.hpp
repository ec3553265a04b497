// The viewer without its window, with a live run that it looks at.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "support/begins.hpp"
#include "support/shared_data.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/heard_link.hpp"

namespace palpa::viewer {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class LiveApp : public testing::Test {
 protected:
  using Kind = WindowEvent::Kind;

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
  /// A live run of the cube, with further options of the application.
  void begin(const std::string& source, ViewerOptions options = {}) {
    app_.reset();
    heard_ = std::make_shared<test::HeardSound>();
    options.input.scene = scene_;
    options.given.merge(line::Given{{"--scene", {scene_}},
                                    {"--gltf-scene", {"0"}},
                                    {"--source", {source}},
                                    {"--layout", {"autd3"}},
                                    {"--backend", {"cpu"}},
                                    {"--noise-free", {}},
                                    {"--hold", {"5s"}},
                                    {"--link", {"heard"}}});
    make(options);
  }
  void make(const ViewerOptions& options) {
    app_.reset();
    AppHost host;
    host.kinds.links.push_back(test::heard_link(heard_));
    host.stop = &stop_;
    host.panels = panels_;
    host.hands = hands_;
    host.copy = [this](const std::string& text) { copied_ = text; };
    host.goes_live = [this] { ++went_live_; };
    app_ = std::make_unique<App>(options, size_, std::move(host));
  }
  /// A fingertip 3 mm in the cube, with further options.
  void make_touch(line::Given more = {}) {
    more.merge(line::Given{{"--scene", {scene_}},
                           {"--points", {test::source_file("assets/finger.ply")}},
                           {"--penetration", {"3mm"}},
                           {"--backend", {"cpu"}}});
    make(options_of(more));
  }

  /// Runs the loop, with steps of a tenth of a second of the application's clock.
  bool goes_round_until(const std::function<bool()>& condition) {
    return test::begins([&] {
      if (condition()) return true;
      go_round();
      return false;
    });
  }
  void go_round(int times = 1) {
    for (int i = 0; i < times; ++i)
      app_->advance(now_s_ += 0.1, size_);
  }
  LiveState state() const { return app_->data().content.run.state; }
  bool comes_to(LiveState wanted) {
    return goes_round_until([&] { return state() == wanted; });
  }
  bool comes_to_sound() {
    return goes_round_until([&] { return app_->data().content.run.sounding; });
  }
  bool shows_frame() {
    return goes_round_until([&] { return app_->showed_frame(); });
  }
  /// Whether the array is silent and nothing begins for seconds of its clock; otherwise it would have begun at once.
  bool stays_off() {
    go_round(50);
    return state() == LiveState::ended && stop_ && !heard_->last_sounds;
  }
  void send(const WindowEvent& event) { app_->handle(event, size_); }
  void key(char character, bool ctrl = false) { send({.kind = Kind::key, .ctrl = ctrl, .key = key_of(character)}); }
  void key(Key named) { send({.kind = Kind::key, .key = named}); }
  void button(Kind kind, double x, double y) { send({.kind = kind, .x = x, .y = y}); }
  void drop(const fs::path& file) { send({.kind = Kind::drop, .text = file}); }
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
  bool comes_to_say(const std::string& text) {
    return goes_round_until([&] { return has_said(text); });
  }
  void all_off() { key('o'); }
  Projected pixel_of(const Vec3& world) const {
    return project(projection(app_->data().state.viewpoint, size_.width, size_.height), world);
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
  std::shared_ptr<test::HeardSound> heard_ = std::make_shared<test::HeardSound>();
  std::atomic<bool> stop_{false};
  bool hands_ = true;
  double now_s_ = 0;
  int went_live_ = 0;
  std::string copied_;
  std::unique_ptr<App> app_;
};

/// With panels, and a hand that operates them.
class LiveAppWithPanels : public LiveApp {
 protected:
  explicit LiveAppWithPanels(const Size& size = {400, 300}) : LiveApp(true, size) {}

  virtual void draw(int pictures = 3) {
    for (int i = 0; i < pictures; ++i) {
      go_round();
      app_->render(size_, 1, now_s_);
    }
  }
  /// Presses a key, lets go of it, and draws.
  void tap(Key named) {
    key(named);
    draw();
    send({.kind = Kind::key, .key = named, .down = false});
    draw();
  }
  /// Where the widget is, after a picture has shown it.
  std::optional<Area> place_of_widget(const std::string& name) {
    draw();
    const auto& named = app_->data().places.named;
    const auto found = named.find(name);
    return found == named.end() ? std::nullopt : std::optional(found->second);
  }
  void press_at(double x, double y) {
    button(Kind::move, x, y);
    draw();
    button(Kind::press, x, y);
    draw(1);
  }
  void click_at(double x, double y) {
    press_at(x, y);
    button(Kind::release, x, y);
    draw();
  }
  void click(const Area& area) { click_at((area.left + area.right) / 2, (area.top + area.bottom) / 2); }
  /// Waits for the widget: what it belongs to may still begin.
  void click(const std::string& name) {
    std::optional<Area> area;
    ASSERT_TRUE(goes_round_until([&] {
      area = place_of_widget(name);
      return area.has_value();
    })) << name;
    click(*area);
  }
  /// Types a value into a field and ends it.
  void type(const std::string& field, const std::string& text) {
    click(field);
    send({.kind = Kind::text, .text = text});
    draw();
    tap(Key::enter);
  }
  /// Presses the slider of the ceiling at its end and drags it to the middle, where it is held.
  Vec2 hold_ceiling_in_the_middle() {
    draw();
    const Area slider = app_->data().places.ceiling.value_or(Area());
    const Vec2 middle((slider.left + slider.right) / 2, (slider.top + slider.bottom) / 2);
    press_at(slider.right - 4, middle.y);
    draw();
    button(Kind::move, middle.x, middle.y);
    draw();
    return middle;
  }
  Area all_off_button() { return app_->data().places.all_off.value_or(Area()); }
};

}  // namespace palpa::viewer
