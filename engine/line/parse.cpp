#include "line/parse.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/text.hpp"
#include "line/option_table.hpp"
#include "line/together.hpp"

namespace palpa::line {
namespace {

std::string name_of(const CLI::App& app, const CLI::App& command) {
  return &app == &command ? app.get_name() : fmt::format("{} {}", app.get_name(), command_name(command));
}

std::string shown(const std::string& word) {
  return printable(word, 60);
}

/// The first unused word of the line. The parser keeps unused words in a different order. The search begins at the end,
/// because the value of a used option may equal an unused word.
std::string first_left(const CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> left = app.remaining(true);
  std::string first = left.empty() ? std::string() : left.front();
  for (int i = argc - 1; i > 0; --i) {
    const auto found = std::ranges::find(left, argv[i]);
    if (found == left.end()) continue;
    first = argv[i];
    left.erase(found);
  }
  return first;
}

/// What a mistyped word stands for, as a question; empty if nothing is near.
std::string guess(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_word(word, known);
  return nearest.empty() ? nearest : fmt::format(": did you mean {}?", nearest);
}

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
  }
  return names;
}

bool is_option_of(const CLI::App& command, const std::string& word) {
  return command.get_option_no_throw(word.substr(0, word.find('='))) != nullptr;
}

bool comes_before_subcommand(const CLI::App& command, const std::string& word, int argc, const char* const* argv) {
  for (int i = 1; i < argc && command.get_name() != argv[i]; ++i) {
    if (word == argv[i]) return true;
  }
  return false;
}

std::string unexpected(CLI::App& app, int argc, const char* const* argv) {
  const std::string word = first_left(app, argc, argv);
  const bool option = word.size() > 1 && word.front() == '-';
  const CLI::App& command = chosen_command(app);
  const bool has_commands = !command.get_subcommands([](const CLI::App*) { return true; }).empty();
  if (!option && has_commands) return unknown_subcommand(command, word);
  if (!option) return fmt::format("'{}' does not belong to an option: each value follows its own option", shown(word));
  if (&command == &app || !is_option_of(command, word))
    return fmt::format("{} has no option '{}'{}", name_of(app, command), shown(word),
                       guess(word.substr(0, word.find('=')), options_of(command)));
  if (comes_before_subcommand(command, word, argc, argv))
    return fmt::format("'{}' comes before the subcommand: give it after the subcommand", shown(word));
  return fmt::format("'{}' is not read here: the argument before it ends the options", shown(word));
}

/// The parser's sentence begins with the option's name; a flag's lacks its dashes.
std::string mismatch(const CLI::App& command, const std::string& sentence) {
  std::string name = sentence.substr(0, sentence.find_first_of(": "));
  if (!name.starts_with('-')) name.insert(0, "--");
  const CLI::Option* option = command.get_option_no_throw(name);
  if (option == nullptr) return one_line(sentence);
  if (option->get_expected_max() == 0) return fmt::format("{} takes no value: give it alone", name);
  const std::size_t given = option->results().size() / static_cast<std::size_t>(option->get_expected_max());
  if (given > 1) return fmt::format("{} is given {} times: give it once", name, given);
  return fmt::format("{}: the value is missing, give {}", name, option->get_type_name());
}

}  // namespace

CLI::App& chosen_command(CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : chosen_command(*chosen.front());
}

std::string command_name(const CLI::App& command) {
  const CLI::App* group = command.get_parent();
  // The program itself has no parent and is not part of the name.
  if (group == nullptr || group->get_parent() == nullptr) return command.get_name();
  return fmt::format("{} {}", command_name(*group), command.get_name());
}

std::string unknown_subcommand(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return fmt::format("unknown subcommand '{}'{}", shown(word), guess(word, names));
}

void parse(CLI::App& app, int argc, const char* const* argv) {
  const auto fail = [&](const std::string& fault) {
    const char* mark = fault.ends_with('?') ? "" : ";";
    throw bad_usage(fmt::format("{}{} see {} --help", fault, mark, name_of(app, chosen_command(app))));
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    throw;
  } catch (const CLI::CallForVersion&) {
    throw;
  } catch (const CLI::ExtrasError&) {
    fail(unexpected(app, argc, argv));
  } catch (const CLI::ArgumentMismatch& error) {
    fail(mismatch(chosen_command(app), error.what()));
  } catch (const CLI::RequiredError&) {
    // For a word that is not a subcommand, the parser first reports the missing subcommand.
    fail(app.remaining(true).empty() ? "a subcommand is required" : unexpected(app, argc, argv));
  } catch (const CLI::RequiresError&) {
    fail(misfit(chosen_command(app), given_on(chosen_command(app))));
  } catch (const CLI::ExcludesError&) {
    fail(misfit(chosen_command(app), given_on(chosen_command(app))));
  } catch (const CLI::ParseError& error) {
    fail(one_line(error.what()));
  }
}

}  // namespace palpa::line
