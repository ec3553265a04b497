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
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/reviewed_options.hpp"
#include "cli/support/told.hpp"
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

class EveryReviewedLine : public testing::Test {
 protected:
  /// The words of a text, with the folders that it names.
  std::vector<std::string> words_of(const std::string& text) const {
    return test::words_of(
        text, {{"ROOT/", source_file("") / ""}, {"SCRATCH/", folder_ / ""}, {"OUT/", folder_ / "out" / ""}});
  }
  /// The line's results. OUT/ is empty before it.
  Results results_of(const std::vector<std::string>& line) const {
    const fs::path out = folder_ / "out";
    fs::remove_all(out);
    fs::create_directory(out);
    const Result result = palpa_here(line);
    static const std::regex measured(R"("timing_ms": \{[^}]*\}|[0-9.]+ m?s\b)");
    Results results{{"exit", std::to_string(result.exit_code)}, {"out", std::regex_replace(result.out, measured, "")}};
    for (const auto& entry : fs::directory_iterator(out)) {
      const std::string text = read_text(entry.path());
      const bool numbers = entry.path().extension() == ".json";
      results[entry.path().filename()] = numbers ? std::regex_replace(text, measured, "") : text;
    }
    return results;
  }

  const fs::path folder_ = scratch_folder("idle-options");
  const std::vector<ReviewedLine> lines_ = reviewed_lines(folder_);
};

TEST_F(EveryReviewedLine, RefusesIdleOptions) {
  for (const ReviewedLine& reviewed : lines_) {
    for (const IdleOptions& idle : reviewed.idle) {
      for (const std::string& text : idle.given) {
        const std::vector<std::string> given = words_of(text);
        std::string told = idle.told;
        if (const std::size_t at = told.find("OPTION"); at != std::string::npos) told.replace(at, 6, given[0]);
        expect_refused(words_of(reviewed.line), {{given, told}});
      }
    }
  }
}

TEST_F(EveryReviewedLine, HasOtherResultsWithEffectiveOptions) {
  int tried = 0, looked_at = 0;
  for (const ReviewedLine& reviewed : lines_) {
    std::map<std::vector<std::string>, Results> before;
    for (const EffectiveOptions& effective : reviewed.effective) {
      for (const std::string& text : effective.given) {
        if (instrumented() && looked_at++ % 3 != 0) continue;
        const std::vector<std::string> line =
            words_of((reviewed.tried_as.empty() ? reviewed.line : reviewed.tried_as) + " " + effective.beside);
        const std::vector<std::string> given = words_of(text);
        SCOPED_TRACE(testing::PrintToString(line) + " " + text);
        if (!before.contains(line)) before[line] = results_of(line);
        const Results after = results_of(with(without(line, given[0]), given));
        ASSERT_EQ(before[line].at("exit"), "0");
        EXPECT_EQ(after.at("exit"), "0");
        EXPECT_TRUE(after != before[line]) << "it has no effect";
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, instrumented() ? 40 : 100);
}

TEST_F(EveryReviewedLine, HasEveryOptionOfItsCommandSomewhere) {
  for (const std::string& command : every_command()) {
    std::set<std::string> reviewed;
    for (const ReviewedLine& one : lines_) {
      if (!is_of(words_of(one.line), command)) continue;
      for (const std::string& option : words_of(common + one.untried))
        reviewed.insert(option);
      for (const IdleOptions& idle : one.idle) {
        for (const std::string& given : idle.given)
          reviewed.insert(words_of(given)[0]);
      }
      for (const EffectiveOptions& effective : one.effective) {
        for (const std::string& given : effective.given)
          reviewed.insert(words_of(given)[0]);
      }
    }
    EXPECT_FALSE(reviewed.empty()) << "palpa " << command << " has no line in reviewed_options.cpp";
    for (const HelpedOption& option : options_of(command))
      EXPECT_TRUE(reviewed.contains(option.name))
          << "palpa " << command << " " << option.name << ": where has it no effect?";
  }
}

}  // namespace
}  // namespace palpa::test
