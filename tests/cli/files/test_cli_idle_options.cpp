// No option is ignored silently. Each option of each command, as its help lists them, is known to have an effect, or is
// refused on lines on which it has none: a new option must be added to reviewed_options.cpp. Effects that are cheap to
// try are tried. (--layout beside --rig is no exception: it replaces the rig's array, as each --help says.)
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/reviewed_options.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

/// A line without a GPU's options takes --backend and --seed wherever a program might: nothing is computed on a GPU,
/// and nothing is random there.
const char* const common = "--backend --json --quiet --log-level --seed --allow-outside ";

/// Everything that a line printed and wrote, by the name of the file; without what it measured.
using Results = std::map<std::string, std::string>;

class IdleOptions : public testing::Test {
 protected:
  /// The line's results. OUT in its words is an empty folder.
  Results results_of(const std::vector<std::string>& line) {
    const fs::path out = folder_ / "out";
    fs::remove_all(out);
    fs::create_directory(out);
    std::vector<std::string> words = line;
    for (std::string& word : words) {
      if (const std::size_t at = word.find("OUT/"); at != std::string::npos) word.replace(at, 3, out.string());
    }
    const Result result = palpa_here(words);
    static const std::regex measured(R"("timing_ms": \{[^}]*\}|[0-9.]+ m?s\b)");
    Results results{{"exit", std::to_string(result.exit_code)}, {"out", std::regex_replace(result.out, measured, "")}};
    for (const auto& entry : fs::directory_iterator(out)) {
      const std::string text = read_text(entry.path());
      const bool numbers = entry.path().extension() == ".json";
      results[entry.path().filename()] = numbers ? std::regex_replace(text, measured, "") : text;
    }
    return results;
  }

  fs::path folder_ = scratch_folder("idle-options");
  std::vector<ReviewedLine> lines_ = reviewed_lines(folder_);
};

TEST_F(IdleOptions, AreRefused) {
  std::set<std::string> programs;
  for (const ReviewedLine& reviewed : lines_) {
    for (const IdleOption& idle : reviewed.idle) {
      SCOPED_TRACE(testing::PrintToString(reviewed.line) + " " + idle.given[0]);
      const std::vector<std::string> line = with(reviewed.line, idle.given);
      expect_failure(palpa_here(line), 2, idle.told);
      // Also run one line of each command with the program itself.
      if (!programs.insert(line[0]).second) continue;
      RunOptions options;
      options.timeout_s = 20;
      expect_failure(palpa(line, options), 2, idle.told);
    }
  }
}

TEST_F(IdleOptions, EffectiveOnesChangeTheResults) {
  int tried = 0, looked_at = 0;
  for (const ReviewedLine& reviewed : lines_) {
    std::map<std::vector<std::string>, Results> before;
    for (const EffectiveOption& option : reviewed.effective) {
      if (instrumented() && looked_at++ % 3 != 0) continue;
      const std::vector<std::string> line =
          with(reviewed.tried_as.empty() ? reviewed.line : reviewed.tried_as, option.beside);
      SCOPED_TRACE(testing::PrintToString(line) + " " + testing::PrintToString(option.given));
      if (!before.contains(line)) before[line] = results_of(line);
      const Results after = results_of(with(without(line, option.given[0]), option.given));
      ASSERT_EQ(before[line].at("exit"), "0");
      EXPECT_EQ(after.at("exit"), "0");
      EXPECT_TRUE(after != before[line]) << "it has no effect";
      ++tried;
    }
  }
  EXPECT_GT(tried, instrumented() ? 40 : 100);
}

TEST_F(IdleOptions, EveryOptionOfEveryCommandWasLookedAt) {
  for (const std::string& command : every_command()) {
    std::set<std::string> reviewed;
    for (const ReviewedLine& one : lines_) {
      if (!is_of(one.line, command)) continue;
      for (const std::string& option : words_of(common + one.untried))
        reviewed.insert(option);
      for (const IdleOption& idle : one.idle)
        reviewed.insert(idle.given[0]);
      for (const EffectiveOption& option : one.effective)
        reviewed.insert(option.given[0]);
    }
    EXPECT_FALSE(reviewed.empty()) << "palpa " << command << " has no line in reviewed_options.cpp";
    for (const HelpedOption& option : options_of(command))
      EXPECT_TRUE(reviewed.contains(option.name))
          << "palpa " << command << " " << option.name << ": where has it no effect?";
  }
}

}  // namespace
}  // namespace palpa::test
