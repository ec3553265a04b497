// The Run panel's options compared with those of the real `palpa run`.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "cli/support/process.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

TEST(RunOptions, ArePalpaRunsOwn) {
  std::set<std::string> shown;
  for (const auto* table : {&live_table(), &copied_table()})
    for (const line::OptionInfo& info : *table)
      EXPECT_TRUE(shown.insert(info.name).second) << info.name << " stands twice";

  std::set<std::string> helped;
  const std::regex option("^  (--[a-z0-9-]+)");
  std::istringstream help(test::palpa({"help", "run", "all"}).out + test::palpa({"help", "all"}).out);
  for (std::string line; std::getline(help, line);) {
    if (std::smatch found; std::regex_search(line, found, option)) helped.insert(found[1]);
  }
  EXPECT_GT(helped.size(), 40u);
  EXPECT_EQ(shown, helped);
}

}  // namespace
}  // namespace palpa::viewer
