// Escape closes what is innermost, and how the viewer ends.
#include <gtest/gtest.h>

#include "live_app.hpp"

namespace palpa::viewer {
namespace {

class Escape : public LiveAppWithPanels {
 protected:
  Escape() : LiveAppWithPanels({900, 600}) {}
  void escape() {
    key(Key::escape);
    draw();
    key(static_cast<char>(Key::escape), false);
    draw();
  }
};

TEST_F(Escape, ClosesAListAndLeavesTheRunAlone) {
  ASSERT_TRUE(comes_to(LiveState::running));
  click("copy");
  ASSERT_TRUE(app_->data().places.list);
  escape();
  EXPECT_FALSE(app_->data().places.list);
  EXPECT_FALSE(app_->quitting());
  EXPECT_EQ(app_->data().content.run.state, LiveState::running);
}

TEST_F(Escape, ClosesTheInnermostFirst) {
  ASSERT_TRUE(comes_to(LiveState::running));
  key('g');
  draw();
  ASSERT_TRUE(app_->data().placing->chosen());
  key('h');
  click("open");
  ASSERT_TRUE(app_->data().picker);
  escape();
  EXPECT_FALSE(app_->data().picker);
  EXPECT_TRUE(app_->data().help);
  escape();
  EXPECT_FALSE(app_->data().help);
  EXPECT_TRUE(app_->data().placing->chosen());
  escape();
  EXPECT_FALSE(app_->data().placing->chosen());
  escape();
  EXPECT_FALSE(app_->quitting()) << "a run never ends by Escape";
  EXPECT_TRUE(says("Q quits"));
}

TEST_F(Escape, LetsGoOfASliderAndLeavesItsValue) {
  ASSERT_TRUE(comes_to(LiveState::running));
  draw();
  const Area slider = app_->data().places.ceiling.value_or(Area());
  const double middle = (slider.left + slider.right) / 2, y = (slider.top + slider.bottom) / 2;
  button(WindowEvent::Kind::move, slider.right - 4, y);
  draw();
  button(WindowEvent::Kind::press, slider.right - 4, y);
  draw();
  button(WindowEvent::Kind::move, middle, y);
  draw();
  ASSERT_TRUE(app_->data().ceiling);
  escape();
  button(WindowEvent::Kind::release, middle, y);
  draw();
  EXPECT_EQ(options().safety.ceiling, 1);
  EXPECT_FALSE(says("Q quits")) << "the slider was innermost";
}

TEST_F(Escape, QuittingWhileTheArraySoundsTakesTwoPresses) {
  ASSERT_TRUE(goes_round_until([&] { return app_->data().content.run.sounding; }));
  key('q');
  EXPECT_FALSE(app_->quitting());
  EXPECT_TRUE(says("press Q again"));
  now_s_ += 2.5;
  go_round();
  ASSERT_TRUE(goes_round_until([&] { return app_->data().content.run.sounding; }));
  key('q');
  EXPECT_FALSE(app_->quitting()) << "too late to be the second press";
  key('q');
  EXPECT_TRUE(app_->quitting());
}

TEST_F(Escape, QuittingInSilenceTakesOne) {
  ASSERT_TRUE(comes_to(LiveState::running));
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  key('q');
  EXPECT_TRUE(app_->quitting());
}

}  // namespace
}  // namespace palpa::viewer
