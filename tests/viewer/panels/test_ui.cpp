// The keys that panels take as text.
#include "viewer/panels/ui.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "viewer/panels/file_font.hpp"

namespace palpa::viewer {
namespace {

TEST(UiKeys, AreTextFromThePressOnAFieldToItsEnd) {
  Ui ui(false);
  const auto picture = [&] {
    ui.begin(200, 100, 1, 0.01);
    ui.end();
  };
  const auto typed = [&](Key key) {
    const bool taken = ui.take({.kind = WindowEvent::Kind::key, .key = key});
    ui.take({.kind = WindowEvent::Kind::key, .key = key, .down = false});
    return taken;
  };
  const WindowEvent press{.kind = WindowEvent::Kind::press};
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

/// Where fontconfig is missing, there is no file, and palpa's own strokes are used.
TEST(FileFont, IsDrawnInPlaceOfStrokes) {
  const std::string file = fontconfig_file();
  if (file.empty()) GTEST_SKIP() << "skipped: no fontconfig, or no font";
  Ui ui(false);
  const auto coverage = [&] {
    ui.begin(200, 100, 1, 0.01);
    return ui.end().glyphs->coverage;
  };
  const auto strokes = coverage();
  ui.use_font(test::read_text(file));
  EXPECT_NE(coverage(), strokes) << file;
  ui.use_font("no font");
  EXPECT_EQ(coverage(), strokes);
}

TEST(UiKeys, OneThatIsHeldDownIsOneChange) {
  Ui ui(false);
  for (int i = 0; i < 100; ++i)
    ui.take({.kind = WindowEvent::Kind::key, .key = key_of('a')});
  int pictures = 0;
  for (; ui.restless() && pictures < 100; ++pictures) {
    ui.begin(200, 100, 1, 0.01);
    ui.end();
  }
  EXPECT_LE(pictures, 3);
}

}  // namespace
}  // namespace palpa::viewer
