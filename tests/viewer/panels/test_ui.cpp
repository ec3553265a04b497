// The keys that panels take as text.
#include "viewer/panels/ui.hpp"

#include <gtest/gtest.h>

namespace palpa::viewer {
namespace {

TEST(UiKeys, AreTextFromThePressOnATextOn) {
  Ui ui(false);
  const auto picture = [&] {
    ui.begin(200, 100, 1, 0.01);
    ui.end();
  };
  const auto typed = [&](Key key) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::key;
    event.key = key;
    const bool taken = ui.take(event);
    event.down = false;
    ui.take(event);
    return taken;
  };
  WindowEvent press;
  press.kind = WindowEvent::Kind::press;
  picture();
  EXPECT_FALSE(typed(key_of('o')));
  ui.take(press, true);
  EXPECT_TRUE(typed(key_of('o'))) << "no picture came between";
  EXPECT_TRUE(typed(Key::enter));
  EXPECT_FALSE(typed(key_of('o'))) << "that ended it";
  ui.take(press, true);
  ui.take(press, false);
  EXPECT_FALSE(typed(key_of('o'))) << "elsewhere";
}

TEST(UiKeys, OneThatIsHeldDownIsOneChange) {
  Ui ui(false);
  WindowEvent event;
  event.kind = WindowEvent::Kind::key;
  event.key = key_of('a');
  for (int i = 0; i < 100; ++i)
    ui.take(event);
  int pictures = 0;
  for (; ui.restless() && pictures < 100; ++pictures) {
    ui.begin(200, 100, 1, 0.01);
    ui.end();
  }
  EXPECT_LE(pictures, 3);
}

}  // namespace
}  // namespace palpa::viewer
