// Escape closes what is innermost, and how the viewer ends.
#include <gtest/gtest.h>

#include "live_app.hpp"

namespace palpa::viewer {
namespace {

class Escape : public LiveAppWithPanels {
 protected:
  Escape() : LiveAppWithPanels({900, 600}) {}
};

TEST_F(Escape, ClosesTheInnermostFirstAndNeverARun) {
  ASSERT_TRUE(comes_to(LiveState::running));
  click("copy");
  ASSERT_TRUE(app_->data().places.list);
  tap(Key::escape);
  EXPECT_FALSE(app_->data().places.list);
  key('g');
  draw();
  ASSERT_TRUE(app_->data().placing->chosen());
  key('h');
  click("open");
  ASSERT_TRUE(app_->data().picker);
  tap(Key::escape);
  EXPECT_FALSE(app_->data().picker);
  EXPECT_TRUE(app_->data().help);
  tap(Key::escape);
  EXPECT_FALSE(app_->data().help);
  EXPECT_TRUE(app_->data().placing->chosen());
  tap(Key::escape);
  EXPECT_FALSE(app_->data().placing->chosen());
  EXPECT_FALSE(says("Q quits"));
  tap(Key::escape);
  EXPECT_TRUE(says("Q quits"));
  EXPECT_FALSE(app_->quitting());
  EXPECT_EQ(state(), LiveState::running);
}

TEST_F(Escape, LetsGoOfASliderAndLeavesItsValue) {
  ASSERT_TRUE(comes_to(LiveState::running));
  const Vec2 held = hold_ceiling_in_the_middle();
  ASSERT_TRUE(app_->data().ceiling);
  ASSERT_TRUE(goes_round_until([&] { return heard_->last_sounds && heard_->loudest < 0.6; })) << "the array follows";
  tap(Key::escape);
  button(Kind::release, held.x, held.y);
  draw();
  EXPECT_EQ(options().safety.ceiling, 1);
  // The next frame is as loud. Seconds of sound are enough for a machine that is slow to compute it.
  const std::uint64_t enough = heard_->sounding + 2000;
  bool follows = false;
  ASSERT_TRUE(goes_round_until([&] {
    follows = heard_->last_sounds && heard_->loudest > 0.99;
    return follows || heard_->sounding > enough;
  }));
  EXPECT_TRUE(follows) << "as the slider shows";
  EXPECT_FALSE(says("Q quits")) << "the slider was innermost";
}

struct EscapeInFields : LiveAppWithPanels {
  EscapeInFields() : LiveAppWithPanels({900, 1600}) {}
};

/// What was typed into a field, or opened, is gone, and no other run begins.
TEST_F(EscapeInFields, LeavesWhatWasTypedIntoAFieldOrOpenedAsItWas) {
  ASSERT_TRUE(comes_to(LiveState::running));
  click("Run");
  click("Touch");
  const std::string before = app_->data().content.edit.command();
  const int runs = went_live_;
  int tried = 0;
  draw();
  const auto named = app_->data().places.named;
  for (const auto& [name, first] : named) {
    if (!name.starts_with("--") || name.ends_with(" reset") || name.ends_with(" file")) continue;
    const auto area = place_of_widget(name);
    if (!area || area->bottom > size_.height || area->top < 40) continue;
    SCOPED_TRACE(name);
    click(*area);
    if (app_->data().content.edit.command() != before) {  // a switch
      click(*area);
    } else {
      ++tried;
      send({.kind = Kind::text, .text = "7"});
      draw();
      EXPECT_EQ(app_->data().content.edit.command(), before) << "not yet finished";
      tap(Key::escape);
    }
    EXPECT_EQ(app_->data().content.edit.command(), before);
    EXPECT_FALSE(says("Q quits"));
  }
  EXPECT_GT(tried, 5) << "of " << named.size();
  EXPECT_EQ(went_live_, runs);
  EXPECT_EQ(state(), LiveState::running);
}

TEST_F(Escape, QuittingTakesTwoPressesWhileTheArraySoundsAndOneInSilence) {
  ASSERT_TRUE(comes_to_sound());
  key('q');
  EXPECT_FALSE(app_->quitting());
  EXPECT_TRUE(says("press Q again"));
  now_s_ += 2.5;
  go_round();
  ASSERT_TRUE(comes_to_sound());
  key('q');
  EXPECT_FALSE(app_->quitting()) << "too late to be the second press";
  key('q');
  EXPECT_TRUE(app_->quitting());
  begin("synthetic");
  ASSERT_TRUE(comes_to(LiveState::running));
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  key('q');
  EXPECT_TRUE(app_->quitting());
}

}  // namespace
}  // namespace palpa::viewer
