// The help pages: their two lengths, their width, and the ways to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "line/help.hpp"
#include "support/thrown.hpp"

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
  const Result result = succeeded(palpa_here(line));
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
  const std::string overview = page({}), group = page({"help", "study"});
  for (const char* word : {"help", "--help", "-h"})
    EXPECT_EQ(page({word}), overview) << word;
  EXPECT_LE(lines_of(overview).size(), line::most_usual_lines);
  for (const std::string& command : every_command())
    EXPECT_CONTAINS(overview, "\n  " + command + " ");
  EXPECT_CONTAINS(overview, "palpa help touch");
  for (const char* name : {"analyse", "compare", "power"})
    EXPECT_CONTAINS(group, "\n  " + std::string(name) + " ");
  using Line = std::vector<std::string>;
  for (const auto& [line, same] : std::vector<std::pair<Line, Line>>{
           {{"help", "all"}, {"--help", "all"}},
           {{"help", "touch"}, {"touch", "--help"}},
           {{"help", "touch"}, {"touch", "--scene", "none.glb", "--help"}},
           {{"help", "touch", "all"}, {"touch", "--help", "all"}},
           {{"help", "touch", "all"}, {"touch", "--help=all"}},
           {{"help", "link", "all"}, {"link", "--help", "all"}},  // it has a word that is no option
           {{"help", "study"}, {"study", "--help"}},
           {{"help", "study", "analyse"}, {"study", "analyse", "--help"}},
           {{"help", "study", "analyse"}, {"help", "study analyse"}},
           {{"help", "study", "power", "all"}, {"study", "power", "--help", "all"}}})
    EXPECT_EQ(page(line), page(same));
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

/// What a shell offers as the value of a command's option, as the lines for this shell say.
std::string offered_by(const std::string& shell, const std::vector<std::string>& lines, const std::string& command,
                       const std::string& option) {
  const bool fish = shell == "fish";
  const std::vector<std::string> words = words_of(command);
  std::string of_command;  // in fish, a part of each line; otherwise the line before its options
  for (const std::string& word : words)
    of_command += fish ? (of_command.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word)
                       : (of_command.empty() ? "" : " ") + word;
  const std::string begin = fish             ? " -n '" + of_command + "' -l " + option.substr(2) + " -d "
                            : shell == "zsh" ? "'*" + option + "["
                                             : "        " + option + ") ";
  auto from = lines.begin();
  while (!fish && from != lines.end() && *from != "  " + of_command + ")" && *from != "  '" + of_command + "')" &&
         *from != "    " + of_command + ")" && *from != "    '" + of_command + "')")
    ++from;
  for (; from != lines.end() && (fish || (*from != "    ;;" && *from != "      esac")); ++from) {
    const std::string& line = *from;
    if (line.find(begin) == std::string::npos) continue;
    const auto has = [&](const char* in_bash, const char* in_zsh, const char* in_fish) {
      return fish ? line.ends_with(in_fish) || line.find(in_fish + std::string(" '")) != std::string::npos
                  : line.find(shell == "zsh" ? in_zsh : in_bash) != std::string::npos;
    };
    if (has("compgen -f", ":_files'", " -r -F")) return "files";
    if (has("compgen -W", ":(", " -x -a")) return "words";
    return has(") return ;;", ":' \\", " -x") ? "nothing" : "no value";
  }
  return shell == "bash" ? "no value" : "no such option";
}

TEST(Help, IsAlsoCompletionForShells) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Result result = succeeded(palpa_here({"help", shell}));
    EXPECT_EQ(result.err, "");
    const std::vector<std::string> lines = lines_of(result.out);
    for (const std::string& command : every_command()) {
      EXPECT_NE(result.out.find(words_of(command).back()), std::string::npos) << shell << " " << command;
      for (const HelpedOption& option : options_of(command)) {
        EXPECT_NE(result.out.find(option.name.substr(2)), std::string::npos) << shell << " " << command << option.name;
        const bool files =
            option.type.find("FILE") != std::string::npos || option.type.find("DIR") != std::string::npos;
        EXPECT_EQ(offered_by(shell, lines, command, option.name), option.type.empty()     ? "no value"
                                                                  : files                 ? "files"
                                                                  : option.type == "WORD" ? "words"
                                                                                          : "nothing")
            << shell << " " << command << " " << option.name << " " << option.type;
      }
    }
  }
}

TEST(Help, SaysDefaultsAndWhereTheWordsAreExplained) {
  const std::string all = page({"help", "run", "all"}), shared = page({"help", "all"});
  EXPECT_CONTAINS(shared, "docs/glossary.md");
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
  EXPECT_TRUE(row(all, "--constraint").ends_with("[default: uniform]"));
  EXPECT_TRUE(row(shared, "--log-level").ends_with("[default: warning]"));
  EXPECT_TRUE(row(shared, "--backend").ends_with("auto|gpu|cpu [default: auto]"));
}

}  // namespace
}  // namespace palpa::test
