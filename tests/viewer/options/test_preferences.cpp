// The settings that the viewer stores.
#include <gtest/gtest.h>

#include "base/log.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "viewer/options/preferences.hpp"

namespace palpa::viewer {
namespace {

TEST(Preferences, ComeBackAsTheyWere) {
  const auto file = test::scratch_folder("viewer-settings") / "made" / "palpa" / "viewer.toml";
  EXPECT_EQ(load_preferences(file), Preferences()) << "none yet";
  Preferences settings;
  settings.dark = true;
  settings.panels = false;
  settings.fine = FinePictures::never;
  settings.skin_colour = SkinColour::ra;
  settings.slots_per_s = 12.5;
  settings.layers[Layer::sections] = {true, 0.25F};
  settings.layers[Layer::solids].visible = false;
  settings.headings = {{"Run", true}, {"View", false}};
  settings.window = WindowPlace{-20, 40, 1000, 700};
  settings.recent = {"/with \"quotes\".glb", "/second.glb"};
  save_preferences(file, settings);
  EXPECT_EQ(load_preferences(file), settings);
  EXPECT_EQ(remembered_window(file), settings.window);
}

TEST(Preferences, WhatALineSaysIsForItsRunAlone) {
  Preferences before, began, now;
  before.layers[Layer::grid].visible = false;
  began = before;
  began.layers[Layer::slice].visible = began.dark = true;  // --show slice --dark
  began.panels = false;                                    // --no-panels
  now = began;
  EXPECT_EQ(to_remember(before, began, now), before);
  now.layers[Layer::solids].opacity = 0.5F;  // by hand
  now.layers[Layer::slice].opacity = 0.25F;
  now.dark = false;
  now.slots_per_s = 12;
  now.skin_colour = SkinColour::pc;
  Preferences expected = before;
  expected.layers[Layer::solids].opacity = 0.5F;
  expected.layers[Layer::slice].opacity = 0.25F;
  expected.slots_per_s = 12;
  expected.skin_colour = SkinColour::pc;
  EXPECT_EQ(to_remember(before, began, now), expected);
  EXPECT_EQ(to_remember(expected, began, now), expected) << "asked once more";
}

TEST(Preferences, ThatCannotBeWrittenAreToldOnce) {
  const auto folder = test::scratch_folder("viewer-settings-nowhere");
  test::write_text(folder / "a file", "");
  PreferencesMemory memory(folder / "a file" / "viewer.toml");
  memory.begin({});
  Preferences now;
  log::drop_warnings();
  log::Tail tail;
  const auto told = [&] {
    memory.remember(now);
    std::string all;
    for (const log::Line& line : tail.take())
      all += line.text;
    return all;
  };
  EXPECT_EQ(told(), "") << "as before";
  now.window = WindowPlace{0, 0, 300, 200};
  now.recent = {"/cube.glb"};
  EXPECT_EQ(told(), "") << "it changes by itself";
  for (const bool dark : {true, false}) {
    now.dark = dark;
    now.slots_per_s += 1;
    EXPECT_CONTAINS(told(), "a file");
    EXPECT_EQ(told(), "") << "the same once more";
  }
}

TEST(Preferences, ABrokenFileIsToldWithItsLine) {
  const auto file = test::scratch_folder("viewer-settings-broken") / "viewer.toml";
  for (const char* text : {"dark = 3\n", "dark = true\nnonsense = 1\n", "slots_per_s = 1e9\n",
                           "fine_pictures = \"often\"\n", "finger_colour = \"SA2\"\n", "[layers.solids]\nopacity = 2\n",
                           "[window]\nx = 1\n", "[layers.ghosts]\nvisible = true\n", "= =\n"}) {
    test::write_text(file, text);
    EXPECT_REFUSED(load_preferences(file), file.string());
  }
}

}  // namespace
}  // namespace palpa::viewer
