// The window of `palpa-viewer --by-touch`, without the window: a simulated finger goes to each focus.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <string>
#include <vector>

#include "sensing/rig.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/heard_link.hpp"
#include "viewer/run/run.hpp"
#include "viewer/run/touch_line.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;

/// A person in front of the window.
class Person {
 public:
  Person(const ViewerOptions& options, const LiveSession::Kinds& kinds, TouchGuide* guide)
      : app_(options, size_, {.kinds = kinds, .guide = guide, .stop = &stop_}) {}
  bool sees(const std::function<bool(const Guidance&)>& wanted) {
    return test::begins([&] {
      app_.advance(now_s_ += 0.1, size_);
      app_.render(size_, 1, now_s_);
      return wanted(guidance());
    });
  }
  bool sees_title(const std::string& title) {
    return sees([&](const Guidance& now) { return now.title == title; });
  }
  /// Presses Enter until the finger is seen at the focus, and the title is another.
  bool takes(const std::string& title) {
    return sees_title(title) && sees([&](const Guidance& now) {
             if (now.title == title) key(Key::enter);
             return now.title != title;
           });
  }
  void key(Key named, bool repeat = false) {
    app_.handle({.kind = WindowEvent::Kind::key, .key = named, .repeat = repeat}, size_);
  }
  const Guidance& guidance() const { return *app_.data().guidance; }
  App& app() { return app_; }

 private:
  const Size size_{400, 300};
  std::atomic<bool> stop_{false};
  double now_s_ = 0;
  App app_;
};

/// What the person does; `show` of run_by_touch has no room for it.
std::function<void(Person&)> does;

void show(const ViewerOptions& options, const LiveSession::Kinds& kinds, TouchGuide* guide) {
  Person person(options, kinds, guide);
  does(person);
  EXPECT_TRUE(person.app().finish(60));
}

class ByTouchInTheWindow : public testing::Test {
 protected:
  TouchLine line() const {
    const std::vector<std::string> words{"palpa-viewer", "--by-touch", "--rig",  rig_,     "--link",
                                         "heard",        "--out",      out_,     "--json", json_,
                                         "--backend",    "cpu",        "--hold", "10s",    "--quiet"};
    std::vector<const char*> given;
    for (const std::string& word : words)
      given.push_back(word.c_str());
    EXPECT_TRUE(asks_for_touches(static_cast<int>(given.size()), given.data()));
    return read_touch_line(static_cast<int>(given.size()), given.data()).value();
  }
  void run(std::function<void(Person&)> what) {
    does = std::move(what);
    LiveSession::Kinds kinds;
    kinds.links.push_back(test::heard_link(heard_));
    run_by_touch(line(), kinds, show);
  }
  bool sounds() const { return heard_->last_sounds; }

  fs::path folder_ = test::scratch_folder("viewer-by-touch");
  std::string rig_ = test::source_file("assets/rigs/openmpd-one.toml"), out_ = folder_ / "touched.toml",
              json_ = folder_ / "touched.json";
  std::shared_ptr<test::HeardSound> heard_ = std::make_shared<test::HeardSound>();
};

TEST_F(ByTouchInTheWindow, EightTouchesGiveTheCamerasPoseInSilence) {
  run([&](Person& person) {
    ASSERT_TRUE(person.sees_title("focus 1 of 8"));
    ASSERT_TRUE(test::begins([&] { return sounds(); }));
    EXPECT_EQ(person.app().title(), "cameras by touch");
    EXPECT_FALSE(person.app().data().marks.empty()) << "the focus is shown";
    person.key(Key::right);
    EXPECT_TRUE(person.sees([](const Guidance& now) { return now.keys.find("x +1.0") != std::string::npos; }));
    person.key(key_of('0'));
    // Held down, keys go on that move the focus.
    for (const auto& [key, told] : {std::pair(Key::left, "x -2.0"), {Key::right, "x +2.0"}}) {
      person.key(key);
      person.key(key, true);
      ASSERT_TRUE(person.sees([&](const Guidance& now) { return now.keys.find(told) != std::string::npos; })) << told;
      person.key(key_of('0'));
    }
    person.key(Key::tab);
    EXPECT_FALSE(person.app().data().panels) << "its options are not those of other runs";
    for (int i = 1; i <= 8; ++i)
      ASSERT_TRUE(person.takes("focus " + std::to_string(i) + " of 8")) << i << person.guidance().fault;
    EXPECT_EQ(person.guidance().title, "The cameras are found");
    EXPECT_NE(person.guidance().text.find("front left: 8 touches, "), std::string::npos) << person.guidance().text;
    EXPECT_TRUE(test::begins([&] { return heard_->finished && !sounds(); }));
    EXPECT_FALSE(person.app().quitting()) << "somebody reads the result";
    EXPECT_TRUE(fs::exists(out_)) << "before the window is closed";
    person.key(Key::enter, true);
    EXPECT_TRUE(person.sees([&](const Guidance&) { return true; }));
    EXPECT_FALSE(person.app().quitting()) << "the key is only held down";
    person.key(Key::enter);
    EXPECT_TRUE(person.sees([&](const Guidance&) { return person.app().quitting(); }));
  });
  const sensing::Rig was = sensing::load_rig(rig_), now = sensing::load_rig(out_);
  ASSERT_EQ(now.cameras.size(), 1u);
  EXPECT_GT(now.cameras[0].residual_m.value_or(0), 1e-4);
  const Transform moved = now.cameras[0].T_world_camera * glm::inverse(was.cameras[0].T_world_camera);
  EXPECT_GT(glm::length(transform_point(moved, Vec3(0))), 1e-5) << "a new pose";
  EXPECT_LT(glm::length(transform_point(moved, Vec3(0))), 4e-3);
  EXPECT_NE(test::read_text(json_).find("true"), std::string::npos);
}

TEST_F(ByTouchInTheWindow, EscapeGivesUpInSilence) {
  run([&](Person& person) {
    ASSERT_TRUE(person.takes("focus 1 of 8"));
    ASSERT_TRUE(test::begins([&] { return sounds(); }));
    person.key(Key::escape);
    EXPECT_TRUE(person.sees([&](const Guidance&) { return person.app().quitting(); }));
    EXPECT_TRUE(test::begins([&] { return heard_->finished && !sounds(); }));
  });
  EXPECT_FALSE(fs::exists(out_));
  EXPECT_NE(test::read_text(json_).find("false"), std::string::npos);
}

TEST_F(ByTouchInTheWindow, AfterAllOffTheSameFocusFollows) {
  run([&](Person& person) {
    ASSERT_TRUE(person.takes("focus 1 of 8"));
    ASSERT_TRUE(person.sees_title("focus 2 of 8"));
    person.key(key_of('o'));
    ASSERT_TRUE(person.sees_title("The array is off"));
    EXPECT_TRUE(test::begins([&] { return heard_->finished && !sounds(); }));
    person.key(Key::enter);
    EXPECT_TRUE(person.sees_title("The array is off")) << "nothing is taken";
    heard_->finished = false;
    ASSERT_TRUE(person.sees([&](const Guidance&) { return person.app().data().content.can_start; }));
    const Area start = person.app().data().places.start.value_or(Area());
    const double x = (start.left + start.right) / 2, y = (start.top + start.bottom) / 2;
    person.app().handle({.kind = WindowEvent::Kind::move, .x = x, .y = y}, {400, 300});
    ASSERT_TRUE(person.sees([&](const Guidance&) { return true; }));
    person.app().handle({.kind = WindowEvent::Kind::press, .x = x, .y = y}, {400, 300});
    ASSERT_TRUE(person.sees([&](const Guidance&) { return true; }));
    person.app().handle({.kind = WindowEvent::Kind::release, .x = x, .y = y}, {400, 300});
    EXPECT_TRUE(person.sees_title("Keep your hands away")) << "the empty place is looked at again";
    EXPECT_TRUE(person.takes("focus 2 of 8")) << person.guidance().title;
    EXPECT_EQ(person.guidance().title, "focus 3 of 8");
    person.key(key_of('q'));
    EXPECT_TRUE(person.sees([&](const Guidance&) { return person.app().quitting(); }));
  });
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(ByTouchInTheWindow, LinesThatCannotBeAreRefused) {
  const auto refused = [&](std::vector<const char*> words) {
    words.insert(words.begin(), {"palpa-viewer", "--by-touch"});
    return test::error_of(
        [&] {
          const auto line = read_touch_line(static_cast<int>(words.size()), words.data());
          run_by_touch(line.value(), {}, show);
        },
        Exit::usage);
  };
  EXPECT_TRUE(refused({}).starts_with("--by-touch: --out is missing"));
  EXPECT_TRUE(
      refused({"--out", out_.c_str(), "--source", "joints:hands.jsonl"}).starts_with("--by-touch goes with cameras"));
  EXPECT_TRUE(refused({"--out", out_.c_str(), "--headless"}).starts_with("--headless goes with --interact"));
}

}  // namespace
}  // namespace palpa::viewer
