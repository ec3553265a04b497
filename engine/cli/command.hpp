// How to add a subcommand to `palpa`, from the engine or the driver. A function add_NAME(Program&) adds it to the
// command line. Its work is a function that runs after the complete line has been parsed.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/row.hpp"
#include "cli/doctor.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "setup/options/options.hpp"

namespace CLI {
class App;
}

namespace palpa::cli {

struct Program;

/// The extensions from the driver. main() fills them in, so the engine never includes the driver.
struct Extensions {
  std::vector<DoctorProbe> doctor{};
  std::vector<session::LinkKind> links{};
  std::vector<session::SourceKind> sources{};
  std::vector<std::function<void(Program&)>> commands{};  ///< each adds one command, after the engine's own
  /// The depth cameras that are plugged in, for `palpa doctor --write-rig`. Never throws because of missing hardware.
  std::function<CamerasThere()> cameras{};
  /// Add rows to the suite "links" of `palpa bench`, each from this many timed runs.
  std::vector<std::function<void(std::uint32_t runs, std::vector<bench::Row>& rows)>> benches{};
};

/// Does a subcommand's work; throws Error for every failure. Returning means exit code 0.
using Action = std::function<void()>;

/// The texts of a subcommand in its help (line/help.hpp). No line may have more than line::help_columns.
struct CommandText {
  const char* name;            ///< "touch", or "study analyse" for a subcommand of the group "study"
  const char* summary;         ///< one line, also in `palpa --help`
  const char* examples;        ///< shown below the options, one command per line, indented by two spaces
  const char* usual = "";      ///< the ten options that people use, separated by spaces; "": all of its own
  const char* notes = "";      ///< a sentence or two below the examples
  const char* arguments = "";  ///< placeholders of words that are not options, "BOARD"
};

struct Program {
  CLI::App& app;
  const Extensions& extensions;
  Action action;                                 ///< the action of the subcommand on the line
  const setup::CommonOptions* common = nullptr;  ///< its common options
  std::map<std::string, CommandText> texts{};    ///< of all subcommands, by name
};

/// Adds a group, a word that only precedes subcommands of its own: `palpa study analyse`. Call it before these are
/// added. The summary is one line.
void add_group(Program& program, const char* name, const char* summary);

/// Adds a subcommand; its options go on the returned app. The command has its own struct of options, with a member
/// `CommonOptions common`, which lives as long as the program. Call `finish_command` after adding the command's own
/// options, so that the common ones come last in the help.
CLI::App& add_command(Program& program, const CommandText& text);
void finish_command(Program& program, CLI::App& command, setup::CommonOptions& common, Action action,
                    setup::Computes computes = setup::Computes::anywhere);

/// Adds one subcommand: `add` adds the members of a new Options to the command line, `run` does the work with them.
template <typename Options>
void add_subcommand(Program& program, const CommandText& text, void (*add)(CLI::App&, Options&),
                    std::function<void(const Options&)> run, setup::Computes computes = setup::Computes::anywhere) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = add_command(program, text);
  add(command, *options);
  finish_command(
      program, command, options->common, [options, run = std::move(run)] { run(*options); }, computes);
}

}  // namespace palpa::cli
