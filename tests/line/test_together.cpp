// Options that need or exclude each other: on a line that is parsed, and as values from elsewhere.
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "line/parse.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "support/thrown.hpp"

namespace palpa::line {
namespace {

struct Command {
  CLI::App app{"", "try"};
  std::string touch, layout;
  double slot = 0;
  bool linear = false;

  Command() {
    const Group group(app, "What");
    group.number("--slot", slot, {0, 10}, "N", "a slot");
    group.text("--touch", touch, "FILE", "a touch");
    group.text("--layout", layout, "NAME", "an array");
    Group(app, "How").flag("--linear", linear, "linear");
    need(app, {"--slot"}, "--touch");
    exclude(app, "--linear", {"--layout"});
  }
  void read(const std::vector<const char*>& words) {
    std::vector<const char*> line{"try"};
    line.insert(line.end(), words.begin(), words.end());
    parse(app, static_cast<int>(line.size()), line.data());
  }
};

TEST(Together, AreRefusedByTheParser) {
  EXPECT_ERROR(Command().read({"--slot", "1"}), Exit::usage, "--slot goes with --touch; see try --help");
  EXPECT_ERROR(Command().read({"--linear", "--layout", "a"}), Exit::usage,
               "--layout and --linear exclude each other: give one of them; see try --help");
  EXPECT_ERROR(Command().read({"--slot", "11"}), Exit::usage, "out of range");
  Command both;
  both.read({"--slot", "1", "--touch", "a", "--linear"});
  EXPECT_EQ(both.slot, 1);
  EXPECT_THROW(Command().read({"--slot", "1", "--help"}), CLI::CallForHelp);
}

TEST(Together, AFlagThatImpliesAnotherIsNotGivenBesideIt) {
  CLI::App app("", "try");
  bool whole = false, part = false;
  const Group group(app, "What");
  group.flag("--whole", whole, "whole");
  group.flag("--part", part, "part");
  imply(app, "--part", "--whole");
  const auto read = [&](std::vector<const char*> words) {
    words.insert(words.begin(), "try");
    parse(app, static_cast<int>(words.size()), words.data());
  };
  for (const auto& words : {std::vector{"--part", "--whole"}, std::vector{"--whole", "--part"}})
    EXPECT_ERROR(read(words), Exit::usage, "--whole and --part exclude each other: give one of them; see try --help");
  read({"--part"});
  EXPECT_TRUE(whole && part);
}

TEST(Together, ValuesFromElsewhereAreTheSame) {
  const Command command;
  EXPECT_EQ(misfit(command.app, {{"--slot", {"1"}}}), "--slot goes with --touch");
  EXPECT_EQ(misfit(command.app, {{"--layout", {"a"}}, {"--linear", {}}}),
            "--layout and --linear exclude each other: give one of them");
  EXPECT_EQ(misfit(command.app, {{"--slot", {"1"}}, {"--touch", {"a"}}, {"--unknown", {}}}), "");
  EXPECT_EQ(under(command.app, {"How"}), std::vector<std::string>{"--linear"});
}

TEST(Together, WordsOfALineReadBack) {
  const Given given{{"--slot", {"1"}}, {"--touch", {"-a=b"}}, {"--linear", {}}};
  EXPECT_EQ(words_of(given), (std::vector<std::string>{"--linear", "--slot=1", "--touch=-a=b"}));
  Command command;
  command.read({"--linear", "--slot=1", "--touch=-a=b"});
  EXPECT_EQ(given_on(command.app), given);
}

TEST(Together, AShellReadsTheCommandLineBack) {
  const Command command;
  for (const std::string value : {"plain", "it's", "''", "two words", "\"$HOME\" `id` \\ *;#\n~", "-a=b", ""}) {
    const std::string line = command_line("printf '<%s>'", option_table(command.app), {{"--touch", {value}}});
    FILE* shell = popen(line.c_str(), "r");
    ASSERT_NE(shell, nullptr);
    std::string said(200, '\0');
    said.resize(std::fread(said.data(), 1, said.size(), shell));
    EXPECT_EQ(pclose(shell), 0) << line;
    EXPECT_EQ(said, (value.starts_with('-') ? "<--touch=" : "<--touch><") + value + ">") << line;
  }
}

}  // namespace
}  // namespace palpa::line
