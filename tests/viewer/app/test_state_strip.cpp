// The strip across the top says what the array does, and nothing covers it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "live_app.hpp"
#include "session/links/board_sound.hpp"
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

TEST(ArrayStatus, IsOneOfFourWordsWithTheLink) {
  const auto says = [](const Content& content, const std::string& word, const std::string& more) {
    EXPECT_EQ(array_status(content).word, word) << more;
    EXPECT_EQ(array_status(content).more, more);
  };
  const std::string link = "foci:udp:127.0.0.1:9000";
  Content content = running_with(link);
  EXPECT_EQ(array_status(content).word, "SILENT");
  content.run.sounding = true;
  says(content, "SOUNDING", "on " + link);
  content.run.stuck = true;
  says(content, "MAY SOUND", link + " takes no drives");
  content.run.state = LiveState::ended;
  EXPECT_EQ(array_status(content).word, "OFF") << "whatever sounded last";
  content.run.state = LiveState::failed;
  content.run.fault = "heard: broken";
  says(content, "OFF", "the run has failed: heard: broken");
  session::board_sound("board:1") = session::BoardSound::gone;
  says(content, "MAY SOUND", "the array (board:1) is out of reach: it may still sound, switch it off");
  session::board_sound("board:1") = session::BoardSound::silent;
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
  ASSERT_TRUE(comes_to_sound());
  draw();
  expect_uncovered("at first");
  const auto over = [&](const std::optional<Area>& area, const std::string& name) {
    ASSERT_TRUE(area) << name;
    button(Kind::move, area->left + 3, area->top + 3);
    draw();
    expect_uncovered("over " + name);
  };
  for (const std::string name : {"Run", "Time", "View", "open", "copy"})
    over(place_of_widget(name), name);
  for (const auto& area : {app_->data().places.start, app_->data().places.all_off, app_->data().places.ceiling})
    over(area, "a switch");
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
  begin("synthetic", {.given = {{"--no-panels", {}}}, .no_panels = true});
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_FALSE(place_of_widget("Run"));
  EXPECT_TRUE(app_->data().places.all_off);
  expect_uncovered("without panels from the start");
  key(Key::tab);
  EXPECT_TRUE(place_of_widget("Run"));
}

TEST_F(StateStrip, TheCeilingIsThatOfTheRun) {
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(options().safety.ceiling, 1);
  const Vec2 held = hold_ceiling_in_the_middle();
  EXPECT_EQ(options().safety.ceiling, 1) << "while it is held";
  ASSERT_TRUE(goes_round_until([&] { return heard_->last_sounds && heard_->loudest < 0.6; })) << "the array follows";
  button(Kind::release, held.x, held.y);
  draw();
  EXPECT_NEAR(options().safety.ceiling, 0.5, 0.05);
  ASSERT_TRUE(goes_round_until([&] { return heard_->last_sounds.load(); }));
  EXPECT_NEAR(heard_->loudest, options().safety.ceiling, 0.01) << "the largest amplitude is 1 without a ceiling";
  EXPECT_EQ(heard_->opened, 1) << "the same run";
}

}  // namespace
}  // namespace palpa::viewer
