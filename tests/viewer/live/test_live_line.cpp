// The options of a live run as the viewer keeps them, and the line of `palpa run` that they stand for.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

TEST(LiveLine, GoesThereAndBack) {
  const line::Given given{{"--scene", {"a b.glb"}}, {"--delta", {"2mm"}}, {"--every-frame", {}}, {"--dark", {}}};
  EXPECT_EQ(run_command(given), "palpa run --scene 'a b.glb' --every-frame --delta 2mm");
  const setup::LiveOptions options = live_options(given);
  EXPECT_EQ(options.scene, "a b.glb");
  EXPECT_EQ(options.touch.parameters.delta_m, 2e-3);
  EXPECT_TRUE(options.every_frame);
  EXPECT_ERROR(live_options({{"--scene", {"a.glb"}}, {"--delta", {"-1"}}}), Exit::usage, "--delta: '-1'");
  EXPECT_ERROR(live_options({}), Exit::usage, "--scene is missing");
}

TEST(LiveLine, WhatACommandTellsIsNoneOfTheViewersOwn) {
  EXPECT_EQ(run_command({{"--scene", {"a.glb"}}, {"--json", {"of-the-viewer.json"}}, {"--frames", {"3"}}},
                        {{"--frames", {"300"}}, {"--stats", {"json"}}, {"--quiet", {}}}),
            "palpa run --scene a.glb --frames 300 --stats json --quiet");
  check_copied({{"--frames", {"300"}}, {"--log-level", {"info"}}});
  EXPECT_ERROR(check_copied({{"--frames", {"many"}}}), Exit::usage, "--frames: 'many'");
}

TEST(LiveLine, TheTableHasWordsAndDefaults) {
  bool method = false, delta = false;
  for (const line::OptionInfo& info : live_table()) {
    if (info.name == "--method") method = info.words.size() == 4 && info.initial == "cross-section";
    if (info.name == "--delta")
      delta = info.initial == "1.5mm" && info.type == "LENGTH" && info.help.ends_with("may be");
    EXPECT_EQ(info.type == "WORD", info.words.size() > 1) << info.name;
  }
  EXPECT_TRUE(method && delta);
}

}  // namespace
}  // namespace palpa::viewer
