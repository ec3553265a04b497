// Every option of every command that help lists. No option takes a stdout that cannot be written, and numbers that are
// far too large or small end it as any other does; test_cli_limits.cpp has what is no number.
// No option is ignored silently: each is known to have an effect, or is refused on lines on which it has none, so a new
// option must be added to reviewed_options.cpp. Effects that tests/python/test_every_option.py does not try are tried.
// (--layout beside --rig is no exception: it replaces the rig's array, as each --help says.)
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
#include "support/boards.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

/// One for all tests here, which also share what palpa keeps between runs.
const QuickLines& quick_lines() {
  static const QuickLines lines;
  return lines;
}

std::vector<std::string> with_value(const std::vector<std::string>& line, const std::string& option,
                                    const std::string& value) {
  std::vector<std::string> tried = without(line, option);
  if (option == "--line") return with(tried, {option, value, "0,0,10mm"});
  return with(tried, {option + "=" + value});
}

/// It ends by itself, with one line where it fails, and prints neither NaN nor infinity.
void expect_sane(const Result& result, const std::string& tried) {
  EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 2 || result.exit_code == 4)
      << tried << ": " << result.exit_code << ", signal " << result.signal << ", " << result.err;
  if (result.exit_code != 0) {
    EXPECT_EQ(result.err_lines().size(), 1u) << tried << ": " << result.err;
    EXPECT_TRUE(result.err.starts_with("palpa: error: ")) << tried << ": " << result.err;
  }
  static const std::regex not_a_number(R"((^|[^A-Za-z])-?(nan|inf)([^A-Za-z]|$))");
  EXPECT_FALSE(result.exit_code == 0 && std::regex_search(result.out, not_a_number)) << tried << ": " << result.out;
}

/// The program itself fails on a full stdout.
void expect_full_program(const std::vector<std::string>& line) {
  SCOPED_TRACE(testing::PrintToString(line));
  RunOptions full;
  full.stdout_file = "/dev/full";
  full.timeout_s = 60;
  expect_failure(palpa(line, full), 1, "stdout: cannot be written: No space left on device");
}

TEST(EveryOption, BearsWhatIsFarTooLarge) {
  const QuickLines& lines = quick_lines();
  int tried = 0;
  for (const std::string& command : every_command()) {
    // No value makes these end, they are slow, or they become another program.
    if (command == "emulate" || command == "bench" || command == "study run") continue;
    const std::vector<HelpedOption> options = options_of(command);
    EXPECT_GE(options.size(), 6u) << command;
    std::vector<std::string> line = lines.of(command);
    if (command == "calibrate") line = with(without(line, "--frames"), {"--frames", "1000"});
    if (std::ranges::any_of(options, [](const HelpedOption& o) { return o.name == "--json"; }))
      line = with(line, {"--json", "-"});
    for (const HelpedOption& option : options) {
      // Whole numbers have no -0, which divides as 0 does.
      const std::vector<const char*> extreme = the_first<const char*>(
          1, {"1e300", "-1e300", "1e-300", option.type == "N" || option.type == "N,M" ? "0" : "-0"});
      for (const char* odd : extreme) {
        for (const std::string& value : odd_values(option.type, odd)) {
          expect_sane(palpa_here(with_value(line, option.name, value)), command + " " + option.name + " " + value);
          ++tried;
        }
      }
    }
  }
  EXPECT_GT(tried, instrumented() ? 150 : 700);
}

TEST(EveryOption, PlacesAreWithinReachAndDirectionsAreSo) {
  const QuickLines& lines = quick_lines();
  const std::vector<std::string> scatter = without(lines.of("scatter"), "--point-source");
  for (const char* far : {"1e300,0,0", "0,-1e300,0", "0,0,10001"})
    expect_failure(palpa_here(with(scatter, {"--point-source", far})), 2,
                   "--point-source: '" + std::string(far) + "' is farther");
  const auto force_of = [&](const std::string& way) {
    const Result result = succeeded(palpa_here(with(scatter, {"--plane-wave", way, "--json", "-"})));
    return result.out.substr(0, result.out.find("timing_ms"));
  };
  EXPECT_EQ(force_of("0,0,1e300"), force_of("0,0,1"));
  EXPECT_EQ(force_of("0,0,1e-300"), force_of("0,0,1"));
  // Also where nothing reads them.
  const fs::path target = scratch_folder("target") / "target.stl";
  expect_failure(palpa_here({"calibrate", "--target", target, "--at", "nan"}), 2, "--at");
  EXPECT_FALSE(fs::exists(target));
}

TEST(EveryOption, AStdoutThatIsFullIsAFailureOfEveryCommand) {
  const QuickLines& lines = quick_lines();
  const auto expect_full = [](const std::vector<std::string>& line) {
    SCOPED_TRACE(testing::PrintToString(line));
    expect_failure(palpa_here(line, "/dev/full"), 1, "stdout: cannot be written: No space left on device");
  };
  for (const std::string& command : every_command()) {
    expect_full(with(words_of(command), {"--help"}));
    if (command == "study run") continue;  // needs a display
    const std::vector<std::string> line = lines.of(command);
    if (command == "bench") {
      expect_full_program(line);  // in the test's process, it has no rows
    } else if (command == "emulate") {
      continue;  // the next test
    } else if (command == "export" || command == "decompose") {
      // What they print is less than what they write.
      expect_full(with(line, {"--json", "-"}));
    } else {
      expect_full(line);
    }
    if (command == "bench") continue;  // slow
    for (const HelpedOption& option : options_of(command)) {
      if (option.type.ends_with("|-")) expect_full(with(without(line, option.name), {option.name, "-"}));
    }
  }
  // Three frames are too few for a faint touch to begin with hysteresis.
  expect_full(with(lines.of("run"), {"--events", "-", "--hysteresis", "off"}));
  expect_full_program(with(lines.of("run"), {"--stats", "json"}));
}

TEST(EveryOption, AStdoutThatIsFullIsAFailureOfEmulators) {
  expect_full_program({"emulate", "autd3", "--port", "0"});
  expect_full_program({"emulate", "openmpd", "--serial", "FULL1"});
  PALPA_TERMINAL_OR_SKIP();
  expect_full_program({"emulate", serial_board()});
}

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
  EXPECT_GT(tried, instrumented() ? 12 : 40);
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
