#include "line/option_table.hpp"

#include <CLI/App.hpp>
#include <algorithm>
#include <cstddef>

#include "base/error.hpp"
#include "base/text.hpp"

namespace palpa::line {
namespace {

/// Removes " [initial]", added by Group::add, from the end of a help text.
std::string take_initial(std::string& help) {
  const std::size_t open = help.rfind(" [");
  if (open == std::string::npos || !help.ends_with(']')) return {};
  std::string initial = help.substr(open + 2, help.size() - open - 3);
  help.resize(open);
  return initial;
}

/// Removes ": a|b|c", added by Group::pick.
std::vector<std::string> take_words(std::string& help) {
  std::vector<std::string> words;
  const std::size_t colon = help.rfind(": ");
  if (colon == std::string::npos) return words;
  std::string list = help.substr(colon + 2);
  help.resize(colon);
  for (std::size_t bar = list.find('|'); bar != std::string::npos; bar = list.find('|')) {
    words.push_back(list.substr(0, bar));
    list.erase(0, bar + 1);
  }
  words.push_back(list);
  return words;
}

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-_./:,=+@%").find(c) != std::string_view::npos;
}

std::string quoted_if_needed(const std::string& word) {
  return !word.empty() && std::ranges::all_of(word, is_plain) ? word : shell_quoted(word);
}

}  // namespace

std::string shell_quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text)
    safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return safe + "'";
}

std::vector<OptionInfo> option_table(const CLI::App& app) {
  std::vector<OptionInfo> table;
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_help_ptr() || option == app.get_version_ptr() || option->get_lnames().empty()) continue;
    OptionInfo info;
    info.name = "--" + option->get_lnames().front();
    info.heading = option->get_group();
    info.flag = option->get_expected_max() == 0;
    info.help = option->get_description();
    if (!info.flag) {
      info.type = option->get_type_name();
      info.initial = take_initial(info.help);
      if (info.type == "WORD") info.words = take_words(info.help);
    }
    table.push_back(std::move(info));
  }
  // A group may be continued after another one. --help shows its options together.
  std::map<std::string, std::size_t> headings;
  for (const OptionInfo& info : table)
    headings.try_emplace(info.heading, headings.size());
  std::ranges::stable_sort(table, {}, [&](const OptionInfo& info) { return headings.at(info.heading); });
  return table;
}

Given given_on(const CLI::App& app) {
  Given given;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const bool flag = option->get_expected_max() == 0;
    given["--" + option->get_lnames().front()] = flag ? std::vector<std::string>() : option->results();
  }
  return given;
}

void give(Given& given, const std::string& option, const std::optional<std::string>& text) {
  given.erase(option);
  if (text) given[option] = text->empty() ? std::vector<std::string>() : std::vector{*text};
}

Given known_to(const std::vector<OptionInfo>& table, const Given& given) {
  Given known;
  for (const OptionInfo& info : table) {
    if (const auto found = given.find(info.name); found != given.end()) known.insert(*found);
  }
  return known;
}

void read_given(CLI::App& app, const Given& given) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;
    const auto found = given.find("--" + option->get_lnames().front());
    if (found == given.end()) continue;
    option->clear();
    if (found->second.empty()) option->add_result(option->get_flag_value(option->get_lnames().front(), {}));
    for (const std::string& value : found->second)
      option->add_result(value);
    try {
      option->run_callback();
    } catch (const CLI::ParseError& error) {
      throw bad_usage(one_line(error.what()));
    }
  }
}

std::vector<std::string> words_of(const Given& given) {
  std::vector<std::string> words;
  for (const auto& [name, values] : given) {
    if (values.empty()) words.push_back(name);
    for (const std::string& value : values)
      words.emplace_back(name).append("=").append(value);
  }
  return words;
}

std::string command_line(std::string_view command, const std::vector<OptionInfo>& table, const Given& given) {
  std::string line(command);
  for (const OptionInfo& info : table) {
    const auto found = given.find(info.name);
    if (found == given.end()) continue;
    if (found->second.empty()) line += " " + info.name;
    for (const std::string& value : found->second)
      line += " " + info.name + (value.starts_with('-') ? "=" : " ") + quoted_if_needed(value);
  }
  return line;
}

}  // namespace palpa::line
