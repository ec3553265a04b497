#include "line/help.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <sstream>

namespace palpa::line {
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

bool is_common(const HelpText& text, const OptionInfo& option) {
  return std::ranges::find(text.common, option.name, &OptionInfo::name) != text.common.end();
}

std::string positional_rows(const CLI::App& app) {
  std::string rows;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) rows += help_row(option->get_type_name(), option->get_description());
  }
  return rows.empty() ? rows : rows + "\n";
}

/// The options that people use, in the order of `usual`; all of the command's own if it is empty.
std::string usual_rows(const std::vector<OptionInfo>& own, const std::string& usual) {
  if (usual.empty()) return help_rows(own);
  std::string rows;
  for (const std::string& name : words_in(usual)) {
    const auto found = std::ranges::find(own, name, &OptionInfo::name);
    if (found != own.end()) rows += row_of(*found);
  }
  return rows;
}

/// Under the headings of the command's groups, in the order of the groups' first options.
std::string all_rows(const std::vector<OptionInfo>& own) {
  std::vector<std::string> headings;
  for (const OptionInfo& option : own) {
    if (std::ranges::find(headings, option.heading) == headings.end()) headings.push_back(option.heading);
  }
  std::string rows;
  for (const std::string& heading : headings) {
    rows += fmt::format("{}{}:\n", rows.empty() ? "" : "\n", heading);
    for (const OptionInfo& option : own) {
      if (option.heading == heading) rows += row_of(option);
    }
  }
  return rows;
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

std::string help_rows(const std::vector<OptionInfo>& options) {
  std::string rows;
  for (const OptionInfo& option : options)
    rows += row_of(option);
  return rows;
}

std::string help_page(const CLI::App& app, const HelpText& text, HelpLength length) {
  std::vector<OptionInfo> own = option_table(app);
  std::string named;
  std::erase_if(own, [&](const OptionInfo& option) {
    const bool common = is_common(text, option);
    if (common) named += (named.empty() ? "" : " ") + option.name;
    return common;
  });
  const bool all = length == HelpLength::all;
  std::string page = wrapped(fmt::format("{}: {}", text.name, text.summary), 0);
  page += fmt::format("\nUsage: {}{}{} [OPTION ...]\n\n", text.name, text.arguments.empty() ? "" : " ", text.arguments);
  page += positional_rows(app);
  page += all ? all_rows(own) : usual_rows(own, text.usual);
  page += fmt::format("\nExamples:\n{}\n", text.examples);
  if (!text.notes.empty()) page += "\n" + wrapped(text.notes, 0);
  page += "\n";
  if (!all) page += fmt::format("Every option: {} --help all\n", text.name);
  if (!named.empty()) page += wrapped(fmt::format("Common options ({}): {}", text.common_page, named), 0);
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

}  // namespace palpa::line
