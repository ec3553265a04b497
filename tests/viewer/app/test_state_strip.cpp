// The strip across the top says what the array does, and nothing covers it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "live_app.hpp"
#include "viewer/panel_data/array_status.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

Content running_with(const std::string& link) {
  Content content;
  content.live = true;
  content.run.state = LiveState::running;
  content.edit = LiveEdit({{"--link", {link}}});
  return content;
}

TEST(ArrayStatus, IsOneOfThreeWordsWithTheLink) {
  Content content = running_with("foci:udp:127.0.0.1:9000");
  EXPECT_EQ(array_status(content).word, "SILENT");
  content.run.sounding = true;
  EXPECT_EQ(array_status(content).word, "SOUNDING");
  EXPECT_EQ(array_status(content).more, "on foci:udp:127.0.0.1:9000");
  content.run.stuck = true;
  EXPECT_EQ(array_status(content).word, "SILENT") << "the array was unplugged";
  EXPECT_EQ(array_status(content).more, "foci:udp:127.0.0.1:9000 takes no drives");
  content.run.state = LiveState::ended;
  EXPECT_EQ(array_status(content).word, "OFF") << "whatever sounded last";
  content.run.state = LiveState::failed;
  content.run.fault = "heard: broken";
  EXPECT_EQ(array_status(content).more, "the run has failed: heard: broken");
  content = running_with("null");
  EXPECT_EQ(array_status(content).more, "no array");
  content.run.sounding = true;
  EXPECT_EQ(array_status(content).more, "no array");
  EXPECT_EQ(array_status(Content()).word, "OFF") << "one touch";
}

class StateStrip : public LiveAppWithPanels {
 protected:
  StateStrip() : LiveAppWithPanels({640, 480}) {}

  /// What the newest picture draws after the strip must not reach into it.
  void expect_uncovered(const std::string& when) {
    app_->advance(now_s_ += 0.1, size_);
    const App::Frame frame = app_->render(size_, 1, now_s_);
    ASSERT_NE(frame.sheet, nullptr);
    const double height = strip_height(text_height);
    const auto drawn = [&](const SheetRun& run) {  // the box around its corners, as far as it is not clipped
      Area box{1e9, 1e9, -1e9, -1e9};
      for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
        const auto& at = frame.sheet->corners[i].place;
        box = {std::min<double>(box.left, at.x), std::min<double>(box.top, at.y), std::max<double>(box.right, at.x),
               std::max<double>(box.bottom, at.y)};
      }
      return Area{std::max<double>(box.left, run.left), std::max<double>(box.top, run.top),
                  std::min<double>(box.right, run.left + run.width),
                  std::min<double>(box.bottom, run.top + run.height)};
    };
    const auto is_background = [&](const SheetRun& run) {
      const Area box = drawn(run);
      return box.left <= 1 && box.right >= size_.width - 1.0 && box.top <= 1 && std::abs(box.bottom - height) <= 1;
    };
    const auto& runs = frame.sheet->runs;
    const auto strip = std::ranges::find_if(runs, is_background);
    ASSERT_NE(strip, runs.end()) << when << ": there is no strip";
    for (auto run = strip; run != runs.end(); ++run) {
      const Area box = drawn(*run);
      EXPECT_TRUE(box.bottom <= height + 1 || box.top >= height)
          << when << ": from " << box.top << " to " << box.bottom;
    }
  }
};

TEST_F(StateStrip, StaysInSightWhateverIsOpen) {
  ASSERT_TRUE(goes_round_until([&] { return app_->data().content.run.sounding; }));
  draw();
  expect_uncovered("at first");
  for (const std::string name : {"Run", "Time", "View", "open", "copy"}) {
    const std::optional<Area> area = place_of_widget(name);
    ASSERT_TRUE(area) << name;
    button(WindowEvent::Kind::move, area->left + 3, area->top + 3);
    draw();
    expect_uncovered("over " + name);
  }
  for (const auto& area : {app_->data().places.start, app_->data().places.all_off, app_->data().places.ceiling}) {
    ASSERT_TRUE(area);
    button(WindowEvent::Kind::move, area->left + 3, area->top + 3);
    draw();
    expect_uncovered("over a switch");
  }
  key('h');
  draw();
  expect_uncovered("with the sheet of keys");
  key('h');
  click("open");
  expect_uncovered("while a file is chosen");
  key(Key::escape);
  click("copy");
  expect_uncovered("with a list");
  key(Key::escape);
  key(Key::tab);
  draw();
  expect_uncovered("without panels");
}

TEST_F(StateStrip, StaysWithoutPanels) {
  ViewerOptions options;
  options.input.scene = scene_;
  options.shown = {};
  options.no_panels = true;
  options.given = {{"--scene", {scene_}},  {"--source", {"synthetic"}}, {"--layout", {"autd3"}},
                   {"--backend", {"cpu"}}, {"--link", {"heard"}},       {"--no-panels", {}}};
  make(options);
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_FALSE(place_of_widget("Run"));
  EXPECT_TRUE(app_->data().places.all_off);
  expect_uncovered("without panels from the start");
  key(Key::tab);
  EXPECT_TRUE(place_of_widget("Run"));
}

TEST_F(StateStrip, TheCeilingIsThatOfTheRun) {
  ASSERT_TRUE(comes_to(LiveState::running));
  draw();
  EXPECT_EQ(options().safety.ceiling, 1);
  const Area slider = app_->data().places.ceiling.value_or(Area());
  const double middle = (slider.left + slider.right) / 2, y = (slider.top + slider.bottom) / 2;
  button(WindowEvent::Kind::move, slider.right - 4, y);
  draw();
  button(WindowEvent::Kind::press, slider.right - 4, y);
  draw();
  button(WindowEvent::Kind::move, middle, y);
  draw();
  EXPECT_EQ(options().safety.ceiling, 1) << "while it is held";
  ASSERT_TRUE(goes_round_until([&] { return heard_->last_sounds && heard_->loudest < 0.6; })) << "the array follows";
  button(WindowEvent::Kind::release, middle, y);
  draw();
  EXPECT_NEAR(options().safety.ceiling, 0.5, 0.05);
  ASSERT_TRUE(goes_round_until([&] { return heard_->last_sounds.load(); }));
  EXPECT_NEAR(heard_->loudest, options().safety.ceiling, 0.01) << "the largest amplitude is 1 without a ceiling";
  EXPECT_EQ(heard_->opened, 1) << "the same run";
}

}  // namespace
}  // namespace palpa::viewer
