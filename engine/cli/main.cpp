#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace palpa::cli {
namespace {

/// A file opened later must not land on a descriptor that the shell left closed: what is printed would go into it. A
/// closed stdout becomes one that cannot be written, so that printing to it still fails.
void guard_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(fd, F_GETFD) == -1 && open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY) == -1) return;
  }
}

/// Names from files and arguments may hold anything; an error stays one line.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '.'))
    text.pop_back();
  return text;
}

Exit report(Exit code, const std::string& line) {
  log::drop_warnings();
  log::error(one_line(line));
  return code;
}

/// The formatter leaves two empty lines between groups; one screen has none to spare.
std::string tidy_help(std::string text) {
  for (std::size_t at = 0; (at = text.find("\n\n\n", at)) != std::string::npos;)
    text.erase(at, 1);
  return text;
}

/// The subcommand that was being parsed, for advice: "palpa touch".
std::string place(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    return fmt::format("palpa {}", command->get_name());
  return "palpa";
}

Exit parse_and_run(int argc, const char* const* argv, const Extensions& extensions) {
  CLI::App app("Feel a 3-D model in mid-air: from depth images to a driven ultrasound array.", "palpa");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "show this help and exit");
  app.set_version_flag("--version", "palpa " PALPA_VERSION, "show the version and exit");
  app.footer(
      "Each subcommand explains itself: palpa touch --help\n"
      "Everything inside is SI; the command line also reads units: 1.5mm, 11ms, 40kHz.\n"
      "Exit codes: 0 ok, 1 failed, 2 bad usage, 3 no usable Vulkan device, 4 bad or missing input.");
  Program program{app, extensions, {}, nullptr};
  add_doctor(program);
  add_touch(program);
  add_run(program);
  add_drive(program);
  add_bench(program);

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    write_output("-", tidy_help(app.help()));
    return Exit::ok;
  } catch (const CLI::CallForVersion&) {
    write_output("-", "palpa " PALPA_VERSION "\n");
    return Exit::ok;
  } catch (const CLI::ParseError& error) {
    if (app.get_subcommands().empty() && !app.remaining().empty()) {
      throw bad_usage(fmt::format("there is no subcommand '{}'; see palpa --help", app.remaining().front()));
    }
    std::string line = one_line(error.what());
    // The parser's sentences begin like sentences, an error line does not; an option's name keeps its case.
    if (line.starts_with("A ") || line.starts_with("The ")) line[0] = static_cast<char>(line[0] - 'A' + 'a');
    throw bad_usage(fmt::format("{}; see {} --help", line, place(app)));
  }
  apply_logging(*program.common);
  program.action();
  if (const std::uint64_t errors = gpu::validation_errors()) {
    throw failure(fmt::format("Vulkan validation reported {} error{}", errors, errors == 1 ? "" : "s"));
  }
  log::release_warnings();
  return Exit::ok;
}

}  // namespace

CLI::App& add_command(Program& program, const CommandText& text) {
  CLI::App* command = program.app.add_subcommand(text.name, text.summary);
  command->set_help_flag();
  command->footer(fmt::format("Examples:\n{}", text.examples));
  return *command;
}

void finish_command(Program& program, CLI::App& command, CommonOptions& common, Action action) {
  add_common(command, common);
  // Set again, after the command's own options: groups are shown in the order of their first option.
  command.set_help_flag("-h,--help", "show this help and exit")->group("Common options");
  command.callback([&program, &common, action = std::move(action)] {
    program.action = action;
    program.common = &common;
  });
}

int main(int argc, const char* const* argv, const Extensions& extensions) {
  guard_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  Exit code = Exit::failed;
  try {
    code = parse_and_run(argc, argv, extensions);
  } catch (const Error& error) {
    code = report(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    code = report(Exit::failed, "out of memory");
  } catch (const std::exception& error) {
    code = report(Exit::failed, error.what());
  } catch (...) {
    code = report(Exit::failed, "an unknown exception");
  }
  return static_cast<int>(code);
}

}  // namespace palpa::cli
