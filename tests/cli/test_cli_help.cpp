// The help pages: their two lengths, their width, and the ways to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "base/nearest_word.hpp"
#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "line/help.hpp"

namespace palpa::test {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    lines.push_back(line);
  return lines;
}

std::string page(const std::vector<std::string>& line) {
  const Result result = palpa_here(line);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(result.out.ends_with('\n') && !result.out.ends_with("\n\n")) << result.out;
  EXPECT_EQ(result.out.find("\n\n\n"), std::string::npos) << result.out;
  for (const std::string& printed : lines_of(result.out))
    EXPECT_LE(printed.size(), line::help_columns) << printed;
  return result.out;
}

std::set<std::string> names_in(const std::string& text) {
  std::set<std::string> names;
  for (const HelpedOption& option : options_in(text))
    EXPECT_TRUE(names.insert(option.name).second) << option.name << " stands twice";
  return names;
}

TEST(Help, AWordIsEnough) {
  const std::string overview = page({});
  EXPECT_EQ(page({"help"}), overview);
  EXPECT_EQ(page({"--help"}), overview);
  EXPECT_EQ(page({"-h"}), overview);
  EXPECT_LE(lines_of(overview).size(), line::most_usual_lines);
  for (const std::string& command : every_command())
    EXPECT_NE(overview.find("\n  " + command + " "), std::string::npos) << command;
  EXPECT_NE(overview.find("palpa help touch"), std::string::npos);

  EXPECT_EQ(page({"help", "all"}), page({"--help", "all"}));
  EXPECT_EQ(page({"help", "touch"}), page({"touch", "--help"}));
  EXPECT_EQ(page({"help", "touch", "all"}), page({"touch", "--help", "all"}));
  EXPECT_EQ(page({"help", "touch", "all"}), page({"touch", "--help=all"}));
  EXPECT_EQ(page({"help", "link", "all"}), page({"link", "--help", "all"})) << "it has a word that is no option";
  EXPECT_EQ(page({"touch", "--scene", "none.glb", "--help"}), page({"help", "touch"}));
  EXPECT_EQ(page({"help", "study", "analyse"}), page({"study", "analyse", "--help"}));
  EXPECT_EQ(page({"help", "study", "power", "all"}), page({"study", "power", "--help", "all"}));
  EXPECT_EQ(page({"help", "study analyse"}), page({"help", "study", "analyse"}));
}

TEST(Help, AMistypedWordIsUnderstood) {
  const auto refused = [](const std::vector<std::string>& line, const std::string& told) {
    expect_failure(palpa_here(line), 2, told);
  };
  refused({"tuoch"}, "unknown subcommand 'tuoch': did you mean touch? see palpa --help");
  refused({"help", "tuoch"}, "unknown subcommand 'tuoch': did you mean touch? see palpa --help");
  refused({"touch", "--scnee", "a.glb"}, "palpa touch has no option '--scnee': did you mean --scene?");
  refused({"help", "wave"}, "unknown subcommand 'wave'; see palpa --help");
  refused({"help", "touch", "run"}, "give palpa help one subcommand");
  refused({"study", "analyze"}, "unknown subcommand 'analyze': did you mean analyse? see palpa study --help");
  refused({"help", "study", "pwoer"}, "unknown subcommand 'pwoer': did you mean power? see palpa --help");
  refused({"study"}, "a subcommand is required; see palpa study --help");
  refused({"study", "--seed", "1"}, "palpa study has no option '--seed'; see palpa study --help");
  refused({"study", "power", "--trails", "3"}, "palpa study power has no option '--trails': did you mean --trials?");
  refused({"--quiet", "study", "power"},
          "'--quiet' comes before the subcommand: give it after the subcommand; see palpa study power");
}

TEST(Help, AGroupListsItsSubcommands) {
  const std::string group = page({"study", "--help"});
  EXPECT_EQ(page({"help", "study"}), group);
  for (const char* name : {"analyse", "compare", "power"})
    EXPECT_NE(group.find("\n  " + std::string(name) + " "), std::string::npos) << group;
}

TEST(Help, ComesInTwoLengths) {
  const std::set<std::string> common = names_in(page({"help", "all"}));
  EXPECT_EQ(common, (std::set<std::string>{"--gpu", "--backend", "--json", "--quiet", "--log-level", "--seed",
                                           "--validation", "--allow-outside"}));
  for (const std::string& command : every_command()) {
    SCOPED_TRACE(command);
    const std::string usual = page({"help", command}), all = page({"help", command, "all"});
    const std::set<std::string> few = names_in(usual), every = names_in(all);
    EXPECT_LE(lines_of(usual).size(), line::most_usual_lines);
    EXPECT_EQ(few.size(), std::min<std::size_t>(every.size(), 10)) << "a name in the list of usual options is wrong";
    EXPECT_TRUE(std::ranges::includes(every, few));
    // The options of all commands are described in one place, and named on each page. Some commands lack a few of them.
    const std::set<std::string> of_some{"--allow-outside", "--gpu", "--validation"};
    for (const std::string& name : common) {
      EXPECT_FALSE(every.contains(name)) << name;
      if (!of_some.contains(name)) {
        EXPECT_NE(usual.find(name), std::string::npos) << name;
      }
    }
    const std::vector<std::string> lines = lines_of(usual);
    const auto examples = std::ranges::find(lines, "Examples:");
    ASSERT_NE(examples, lines.end());
    EXPECT_EQ(std::count_if(examples, lines.end(), [](const std::string& l) { return l.starts_with("  palpa "); }), 2);
  }
}

TEST(Help, IsAlsoCompletionForShells) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Result result = palpa_here({"help", shell});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    for (const std::string& command : every_command()) {
      EXPECT_NE(result.out.find(as_words(command).back()), std::string::npos) << shell << " " << command;
      for (const HelpedOption& option : options_of(command))
        EXPECT_NE(result.out.find(option.name.substr(2)), std::string::npos) << shell << " " << command << option.name;
    }
  }
}

TEST(Help, SaysDefaults) {
  const std::string all = page({"help", "run", "all"}), shared = page({"help", "all"});
  const auto row = [](const std::string& text, const std::string& name) {
    const std::size_t at = text.find("\n  " + name + " ");
    EXPECT_NE(at, std::string::npos) << name;
    const std::string rest = text.substr(at + 1);
    std::istringstream words(rest.substr(0, std::min(rest.find("\n  --"), rest.find("\n\n"))));
    std::string joined;
    for (std::string word; words >> word;)
      joined += (joined.empty() ? "" : " ") + word;
    return joined;
  };
  EXPECT_TRUE(row(all, "--foci").ends_with("[default: 10]")) << row(all, "--foci");
  EXPECT_TRUE(row(all, "--dwell").ends_with("[default: 1.5ms]"));
  EXPECT_EQ(
      row(all, "--stride"),
      "--stride N step between consecutive foci; must be coprime with --foci [default: nearest to 0.3 of the foci]");
  EXPECT_NE(row(all, "--method").find(": cross-section|single-focus|"), std::string::npos) << row(all, "--method");
  EXPECT_TRUE(row(all, "--method").ends_with("[default: cross-section]"));
  EXPECT_TRUE(row(all, "--constraint").ends_with("[default: normalise]"));
  EXPECT_TRUE(row(shared, "--log-level").ends_with("[default: warning]"));
  EXPECT_TRUE(row(shared, "--backend").ends_with("auto|gpu|cpu [default: auto]"));
}

TEST(Help, TheWordsAreExplained) {
  EXPECT_NE(page({"help", "all"}).find("docs/glossary.md"), std::string::npos);
}

TEST(Help, LinesAreWrappedAtWords) {
  EXPECT_EQ(line::help_row("--a", "one two"), "  --a                       one two\n");
  EXPECT_EQ(line::help_row("--a-name-as-long-as-this-one N", "one"),
            "  --a-name-as-long-as-this-one N\n                            one\n");
  EXPECT_EQ(line::help_row("--a", ""), "  --a\n");
  std::string words;
  for (int i = 0; i < 60; ++i)
    words += "word ";
  const std::vector<std::string> lines = lines_of(line::wrapped(words, 28));
  ASSERT_EQ(lines.size(), 5u);  // 14 words each
  for (const std::string& line : lines)
    EXPECT_LE(line.size(), line::help_columns) << line;
  const std::string long_word(120, 'x');
  EXPECT_EQ(line::wrapped("a " + long_word + " b", 2), "  a\n  " + long_word + "\n  b\n");
}

TEST(NearestWord, IsOneThatDiffersInAThirdOfItsLetters) {
  const std::vector<std::string> known{"touch", "run", "drive", "calibrate"};
  const auto nearest = [&](const char* word) { return nearest_word(word, known); };
  EXPECT_EQ(nearest("tuoch"), "touch");   // swapped
  EXPECT_EQ(nearest("tuch"), "touch");    // missing
  EXPECT_EQ(nearest("touuch"), "touch");  // extra
  EXPECT_EQ(nearest("toych"), "touch");   // wrong
  EXPECT_EQ(nearest("rum"), "run");
  EXPECT_EQ(nearest("calibarte"), "calibrate");
  EXPECT_EQ(nearest("callibratte"), "calibrate");
  EXPECT_EQ(nearest("toxyz"), "");
  EXPECT_EQ(nearest("r"), "");
  EXPECT_EQ(nearest(""), "");
  EXPECT_EQ(nearest_word(std::string(100'000, 'x'), known), "");
}

}  // namespace
}  // namespace palpa::test
