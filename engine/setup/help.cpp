#include "setup/help.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <sstream>

#include "setup/options.hpp"
#include "setup/values.hpp"

namespace palpa::setup {
namespace {

constexpr std::size_t text_column = 28;

std::vector<std::string> words_in(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; in >> word;)
    words.push_back(word);
  return words;
}

std::string row_of(const OptionInfo& option) {
  std::string text = option.help;
  for (std::size_t i = 0; i < option.words.size(); ++i)
    text += (i == 0 ? ": " : "|") + option.words[i];
  if (!option.initial.empty()) text += fmt::format(" [default: {}]", option.initial);
  return help_row(option.flag ? option.name : option.name + " " + option.type, text);
}

/// The table of the options that every command has. The parser keeps references to the options' values, so these live
/// as long.
struct Common {
  Common() {
    add_common(app, options);
    add_allow_outside(Group(app, "Common options"), options);
  }
  CommonOptions options;
  CLI::App app;
};

const std::vector<OptionInfo>& common_table() {
  static const std::vector<OptionInfo> table = option_table(Common().app);
  return table;
}

bool is_common(const OptionInfo& option) {
  return std::ranges::find(common_table(), option.name, &OptionInfo::name) != common_table().end();
}

std::string positional_rows(const CLI::App& app) {
  std::string rows;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) rows += help_row(option->get_type_name(), option->get_description());
  }
  return rows.empty() ? rows : rows + "\n";
}

/// The options that people use, in the order of `usual`; all of the command's own if it is empty.
std::string usual_rows(const std::vector<OptionInfo>& table, const std::string& usual) {
  std::string rows;
  for (const std::string& name : words_in(usual)) {
    const auto found = std::ranges::find(table, name, &OptionInfo::name);
    if (found != table.end()) rows += row_of(*found);
  }
  for (const OptionInfo& option : table) {
    if (usual.empty() && !is_common(option)) rows += row_of(option);
  }
  return rows;
}

/// Under the headings of the command's groups, in the order of the groups' first options.
std::string all_rows(const std::vector<OptionInfo>& table, bool with_common) {
  std::vector<std::string> headings;
  for (const OptionInfo& option : table) {
    if (is_common(option) && !with_common) continue;
    if (std::ranges::find(headings, option.heading) == headings.end()) headings.push_back(option.heading);
  }
  std::string rows;
  for (const std::string& heading : headings) {
    rows += fmt::format("{}{}:\n", rows.empty() ? "" : "\n", heading);
    for (const OptionInfo& option : table) {
      if (option.heading == heading && (with_common || !is_common(option))) rows += row_of(option);
    }
  }
  return rows;
}

std::string common_names(const std::vector<OptionInfo>& table) {
  std::string names;
  for (const OptionInfo& option : table) {
    if (is_common(option)) names += (names.empty() ? "" : " ") + option.name;
  }
  return names;
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t indent) {
  std::string lines, line;
  for (const std::string& word : words_in(text)) {
    if (!line.empty() && indent + line.size() + 1 + word.size() > help_columns) {
      lines += std::string(indent, ' ') + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? lines : lines + std::string(indent, ' ') + line + "\n";
}

std::string help_row(std::string_view name, std::string_view text) {
  std::string row = fmt::format("  {}", name);
  const std::string lines = wrapped(text, text_column);
  // A long name has a line for itself.
  if (lines.empty() || row.size() + 2 > text_column) return row + "\n" + lines;
  return row + lines.substr(row.size());
}

std::string common_help() {
  std::string rows;
  for (const OptionInfo& option : common_table())
    rows += row_of(option);
  return rows;
}

std::string help_page(const CLI::App& app, const HelpText& text, HelpLength length) {
  const std::vector<OptionInfo> table = option_table(app);
  const bool all = length == HelpLength::all;
  std::string page = wrapped(fmt::format("{}: {}", text.name, text.summary), 0);
  page += fmt::format("\nUsage: {}{}{} [OPTION ...]\n\n", text.name, text.arguments.empty() ? "" : " ", text.arguments);
  page += positional_rows(app);
  page += all ? all_rows(table, text.common.empty()) : usual_rows(table, text.usual);
  page += fmt::format("\nExamples:\n{}\n", text.examples);
  if (!text.notes.empty()) page += "\n" + wrapped(text.notes, 0);
  page += "\n";
  if (!all) page += fmt::format("Every option: {} --help all\n", text.name);
  if (!text.common.empty())
    page += wrapped(fmt::format("Common options ({}): {}", text.common, common_names(table)), 0);
  return page;
}

std::string word_after_help(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word.starts_with("--help=")) return std::string(word.substr(7));
    if ((word == "--help" || word == "-h") && i + 1 < argc) return argv[i + 1];
  }
  return {};
}

HelpLength help_length(int argc, const char* const* argv) {
  return word_after_help(argc, argv) == "all" ? HelpLength::all : HelpLength::usual;
}

}  // namespace palpa::setup
