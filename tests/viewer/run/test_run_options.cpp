// The Run panel's options compared with those of the real `palpa run`.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "cli/support/every_command.hpp"
#include "cli/support/process.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

TEST(RunOptions, ArePalpaRunsOwn) {
  std::set<std::string> shown, helped;
  for (const auto* table : {&live_table(), &copied_table()})
    for (const line::OptionInfo& info : *table)
      EXPECT_TRUE(shown.insert(info.name).second) << info.name << " stands twice";
  const std::string help = test::palpa({"help", "run", "all"}).out + test::palpa({"help", "all"}).out;
  for (const test::HelpedOption& option : test::options_in(help))
    helped.insert(option.name);
  EXPECT_GT(helped.size(), 40u);
  EXPECT_EQ(shown, helped);
}

}  // namespace
}  // namespace palpa::viewer
