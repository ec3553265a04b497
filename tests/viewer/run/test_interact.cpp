// Recorded input and its playback.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/thrown.hpp"
#include "viewer/run/interact.hpp"
#include "viewer/run/script.hpp"

namespace palpa::viewer {
namespace {

TEST(Interact, ReadsEveryVerb) {
  const auto steps = parse_interactions(
      "# a comment\n\n"
      "move 10 20.5   # and another\n"
      "press middle shift\n"
      "release middle\n"
      "scroll -2\n"
      "type a #1 b\n"
      "drop models/a file#2.glb\n"
      "resize 640 480\n"
      "draw 7\n"
      "wait 1.5\n"
      "shot out.png\n"
      "key page-up ctrl\n"
      "key 7",
      "log");
  ASSERT_EQ(steps.size(), 16u);
  EXPECT_EQ(steps[0].event.kind, WindowEvent::Kind::move);
  EXPECT_EQ(steps[0].event.y, 20.5);
  EXPECT_EQ(steps[0].line, 3u);
  EXPECT_EQ(steps[1].event.button, Button::middle);
  EXPECT_TRUE(steps[1].event.shift);
  EXPECT_EQ(steps[1].event.x, 10) << "where the pointer is";
  EXPECT_EQ(steps[3].event.steps, -2);
  EXPECT_EQ(steps[4].event.text, "a") << "what follows a space and a # is a comment";
  EXPECT_EQ(steps[5].event.text, "models/a file#2.glb");
  EXPECT_EQ(steps[6].width, 640u);
  EXPECT_EQ(steps[7].count, 7u);
  EXPECT_EQ(steps[8].seconds, 1.5);
  EXPECT_EQ(steps[9].file, "out.png");
  EXPECT_EQ(steps[10].event.key, Key::page_up);
  EXPECT_TRUE(steps[10].event.ctrl && steps[10].event.down);
  EXPECT_EQ(steps[11].kind, Interaction::Kind::draw) << "a key is pressed, drawn and let go of";
  EXPECT_FALSE(steps[12].event.down);
  EXPECT_EQ(steps[13].event.key, key_of('7'));
}

TEST(Interact, ADragOrAClickLetsGoOfWhatItPresses) {
  using Kind = WindowEvent::Kind;
  struct Case {
    const char* line;
    Button button;
    bool shift, ctrl;
    double from, to;
  };
  for (const Case& one : {Case{"drag 10 20 30 40", Button::left, false, false, 10, 30},
                          {"drag 10 20 30 40 middle", Button::middle, false, false, 10, 30},
                          {"drag 10 20 30 40 right", Button::right, false, false, 10, 30},
                          {"drag 10 20 30 40 right shift", Button::right, true, false, 10, 30},
                          {"drag 10 20 30 40 middle ctrl", Button::middle, false, true, 10, 30},
                          {"click 10 20", Button::left, false, false, 10, 10}}) {
    SCOPED_TRACE(one.line);
    std::vector<WindowEvent> clicks;
    for (const Interaction& step : parse_interactions(one.line, "log")) {
      if (step.kind != Interaction::Kind::event) continue;
      if (step.event.kind != Kind::move) {
        clicks.push_back(step.event);
      } else if (clicks.size() == 1) {
        EXPECT_EQ(step.event.shift, one.shift);
        EXPECT_EQ(step.event.ctrl, one.ctrl);
      }
    }
    ASSERT_EQ(clicks.size(), 2u);
    EXPECT_EQ(clicks[0].kind, Kind::press);
    EXPECT_EQ(clicks[1].kind, Kind::release);
    for (const WindowEvent& click : clicks)
      EXPECT_EQ(click.button, one.button);
    EXPECT_EQ(clicks[0].shift, one.shift);
    EXPECT_EQ(clicks[0].ctrl, one.ctrl);
    EXPECT_EQ(clicks[0].x, one.from);
    EXPECT_EQ(clicks[1].x, one.to);
  }
}

TEST(Interact, RefusesWhatItDoesNotUnderstandWithItsLine) {
  for (const char* wrong : {"jump 1 2", "move 1", "move 1 x", "press up", "key nonsense", "draw 1.5", "draw 0",
                            "wait -1", "resize 0 5", "type", "shot", "move 1 2 3", "press left alt"}) {
    const auto read = [&] { parse_interactions(std::string("draw\n") + wrong, "some.log"); };
    EXPECT_TRUE(test::error_of(read, Exit::bad_input).starts_with("some.log:2: ")) << wrong;
  }
}

TEST(Script, StopsForPicturesAndForTime) {
  Script script(parse_interactions("move 1 1\ndraw 2\nmove 2 2\nwait 0.5\nmove 3 3\nwait 2\n", "log"));
  std::vector<double> places;
  const auto play = [&](double now) {
    script.play(now, [&](const Interaction& step) { places.push_back(step.event.x); });
    return places.size();
  };
  EXPECT_EQ(play(0), 1u);
  script.drew();
  EXPECT_EQ(play(0), 1u) << "one more picture";
  script.drew();
  EXPECT_EQ(play(1), 2u);
  EXPECT_EQ(play(1.4), 2u) << "time has not passed";
  EXPECT_TRUE(script.busy());
  EXPECT_EQ(play(1.6), 3u);
  play(3.5);
  EXPECT_TRUE(script.busy()) << "its last wait is not over";
  play(3.7);
  EXPECT_FALSE(script.busy());
}

}  // namespace
}  // namespace palpa::viewer
