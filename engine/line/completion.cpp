#include "line/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

namespace palpa::line {
namespace {

/// The part of a subcommand's name behind the program's: "study analyse".
std::string words_of(const CompletedCommand& command, const std::string& program) {
  return command.text.name == program ? "" : command.text.name.substr(program.size() + 1);
}

bool takes_file(const OptionInfo& option) {
  return option.type.find("FILE") != std::string::npos || option.type.find("DIR") != std::string::npos;
}

/// The beginning of a help text, for shells that show one line.
std::string short_help(const OptionInfo& option) {
  constexpr std::size_t most = 90;
  const std::string text = option.help.substr(0, option.help.find(';'));
  return text.size() <= most ? text : text.substr(0, text.rfind(' ', most)) + " ...";
}

/// The subcommands' first words with what may follow them.
std::map<std::string, std::vector<std::string>> words_by_first(const std::string& program,
                                                               const std::vector<CompletedCommand>& commands) {
  std::map<std::string, std::vector<std::string>> all;
  for (const CompletedCommand& command : commands) {
    const std::string words = words_of(command, program);
    if (words.empty()) continue;
    const std::size_t space = words.find(' ');
    std::vector<std::string>& seconds = all[words.substr(0, space)];
    if (space != std::string::npos) seconds.push_back(words.substr(space + 1));
  }
  return all;
}

std::string bash_case(const std::string& words, const CompletedCommand& command) {
  std::string text = fmt::format("    {})\n      case $prev in\n", words.empty() ? "*" : shell_quoted(words));
  std::string names;
  for (const OptionInfo& option : command.options) {
    names += (names.empty() ? "" : " ") + option.name;
    if (!option.words.empty()) {
      text += fmt::format("        {}) COMPREPLY=($(compgen -W {} -- \"$cur\")); return ;;\n", option.name,
                          shell_quoted(fmt::format("{}", fmt::join(option.words, " "))));
    } else if (takes_file(option)) {
      text += fmt::format("        {}) COMPREPLY=($(compgen -f -- \"$cur\")); return ;;\n", option.name);
    } else if (!option.flag) {
      text += fmt::format("        {}) return ;;\n", option.name);
    }
  }
  return text + fmt::format("      esac\n      options={} ;;\n", shell_quoted(names + " --help"));
}

std::string bash(const std::string& program, const std::vector<CompletedCommand>& commands) {
  std::string function = program;
  std::ranges::replace(function, '-', '_');
  std::string text = fmt::format(
      "# Completion of {0} for bash, made from its options.\n_{1}() {{\n"
      "  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}} "
      "options=\n",
      program, function);
  const auto firsts = words_by_first(program, commands);
  if (!firsts.empty()) {
    std::string all;
    for (const auto& [first, seconds] : firsts)
      all += first + " ";
    text +=
        fmt::format("  if ((COMP_CWORD == 1)); then\n    COMPREPLY=($(compgen -W {} -- \"$cur\"))\n    return\n  fi\n",
                    shell_quoted(all + "help --help --version"));
    for (const auto& [first, seconds] : firsts) {
      if (seconds.empty()) continue;
      text += fmt::format(
          "  if [[ $command == {0} ]]; then\n    if ((COMP_CWORD == 2)); then\n"
          "      COMPREPLY=($(compgen -W {1} -- \"$cur\"))\n      return\n    fi\n    command+=\" "
          "${{COMP_WORDS[2]}}\"\n  fi\n",
          first, shell_quoted(fmt::format("{}", fmt::join(seconds, " "))));
    }
  }
  text += "  case $command in\n";
  for (const CompletedCommand& command : commands)
    text += bash_case(words_of(command, program), command);
  return text + fmt::format(
                    "  esac\n"
                    "  if [[ $cur == -* ]]; then\n    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n  else\n"
                    "    COMPREPLY=($(compgen -f -- \"$cur\"))\n  fi\n}}\ncomplete -o filenames -F _{} {}\n",
                    function, program);
}

/// An option as zsh's _arguments takes it.
std::string zsh_option(const OptionInfo& option) {
  std::string help = short_help(option);
  for (const char* special : {"[", "]", ":"}) {
    for (std::size_t at = 0; (at = help.find(special, at)) != std::string::npos; at += 2)
      help.insert(at, 1, '\\');
  }
  std::string spec = fmt::format("*{}[{}]", option.name, help);
  if (!option.flag) {
    std::string type = option.type;
    std::ranges::replace(type, ':', ' ');
    spec += fmt::format(":{}:", type);
    if (!option.words.empty()) {
      spec += fmt::format("({})", fmt::join(option.words, " "));
    } else if (takes_file(option)) {
      spec += "_files";
    }
  }
  return fmt::format("      {} \\\n", shell_quoted(spec));
}

std::string zsh(const std::string& program, const std::vector<CompletedCommand>& commands) {
  std::string text = fmt::format("#compdef {0}\n# Completion of {0} for zsh, made from its options.\n", program);
  const auto arguments = [](const CompletedCommand& command) {
    std::string lines = "    _arguments \\\n";
    for (const OptionInfo& option : command.options)
      lines += zsh_option(option);
    return lines + "      '--help[show help]' '*:file:_files'\n";
  };
  const auto firsts = words_by_first(program, commands);
  if (firsts.empty()) return text + arguments(commands.front());
  text += "local -a subcommands\nsubcommands=(\n";
  for (const auto& [first, seconds] : firsts) {
    const auto command = std::ranges::find_if(
        commands, [&, &word = first](const CompletedCommand& one) { return words_of(one, program) == word; });
    text +=
        fmt::format("  {}\n", shell_quoted(command == commands.end() ? first : first + ":" + command->text.summary));
  }
  text +=
      ")\nif ((CURRENT == 2)); then\n  _describe subcommand subcommands\n  return\nfi\nlocal command=$words[2]\nshift "
      "words\n((CURRENT--))\n";
  for (const auto& [first, seconds] : firsts) {
    if (seconds.empty()) continue;
    text += fmt::format(
        "if [[ $command == {} ]]; then\n  if ((CURRENT == 2)); then\n    compadd {}\n    return\n  fi\n"
        "  command+=\" $words[2]\"\n  shift words\n  ((CURRENT--))\nfi\n",
        first, fmt::join(seconds, " "));
  }
  text += "case $command in\n";
  for (const CompletedCommand& command : commands)
    text += fmt::format("  {})\n{}    ;;\n", shell_quoted(words_of(command, program)), arguments(command));
  return text + "esac\n";
}

std::string fish(const std::string& program, const std::vector<CompletedCommand>& commands) {
  std::string text = fmt::format("# Completion of {} for fish, made from its options.\n", program);
  const auto firsts = words_by_first(program, commands);
  for (const auto& [first, seconds] : firsts) {
    const auto command = std::ranges::find_if(
        commands, [&, &word = first](const CompletedCommand& one) { return words_of(one, program) == word; });
    text += fmt::format(
        "complete -c {} -n __fish_use_subcommand -f -a {}{}\n", program, first,
        command == commands.end() ? std::string() : fmt::format(" -d {}", shell_quoted(command->text.summary)));
    if (seconds.empty()) continue;
    text += fmt::format(
        "complete -c {0} -n '__fish_seen_subcommand_from {1}; and not __fish_seen_subcommand_from {2}' -f -a '{2}'\n",
        program, first, fmt::join(seconds, " "));
  }
  for (const CompletedCommand& command : commands) {
    std::istringstream words(words_of(command, program));
    std::string condition;
    for (std::string word; words >> word;)
      condition += (condition.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
    for (const OptionInfo& option : command.options) {
      text += fmt::format("complete -c {}{} -l {} -d {}", program,
                          condition.empty() ? std::string() : fmt::format(" -n {}", shell_quoted(condition)),
                          option.name.substr(2), shell_quoted(short_help(option)));
      if (!option.words.empty()) {
        text += fmt::format(" -x -a '{}'", fmt::join(option.words, " "));
      } else if (!option.flag) {
        text += takes_file(option) ? " -r -F" : " -x";
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace

std::optional<Shell> shell_of(std::string_view word) {
  if (word == "bash") return Shell::bash;
  if (word == "zsh") return Shell::zsh;
  if (word == "fish") return Shell::fish;
  return std::nullopt;
}

std::string completion(Shell shell, const std::string& program, const std::vector<CompletedCommand>& commands) {
  switch (shell) {
    case Shell::bash:
      return bash(program, commands);
    case Shell::zsh:
      return zsh(program, commands);
    case Shell::fish:
      return fish(program, commands);
  }
  return {};
}

}  // namespace palpa::line
