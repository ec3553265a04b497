// How a subcommand of `palpa` plugs in, be it the engine's or one of a room above it: an add_NAME(Program&) puts it on
// the command line, and what it does is a function that runs once the whole line is understood.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/row.hpp"
#include "cli/doctor.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "setup/options.hpp"

namespace CLI {
class App;
}

namespace palpa::cli {

struct Program;

/// What rooms above the engine bring along; main() fills it, so that the engine never includes them.
struct Extensions {
  std::vector<DoctorProbe> doctor{};
  std::vector<session::LinkKind> links{};
  std::vector<session::SourceKind> sources{};
  std::vector<std::function<void(Program&)>> commands{};  ///< each adds one, as the engine's own do; after these
  /// The depth cameras that are plugged in, for `palpa doctor --write-rig`. Never throws for what the machine lacks.
  std::function<CamerasThere()> cameras{};
  /// Rows of `palpa bench`'s suite "links", of that many timed runs.
  std::vector<std::function<void(std::uint32_t runs, std::vector<bench::Row>& rows)>> benches{};
};

/// Does a subcommand's work; throws Error for every failure. Returning means exit code 0.
using Action = std::function<void()>;

struct Program {
  CLI::App& app;
  const Extensions& extensions;
  Action action;                                 ///< of the subcommand on the line
  const setup::CommonOptions* common = nullptr;  ///< its common options
};

/// How a subcommand introduces itself in --help.
struct CommandText {
  const char* name;
  const char* summary;   ///< one line, also in `palpa --help`
  const char* examples;  ///< shown below the options, one command per line
};

/// Adds a subcommand; its options go on the returned app. `options` is the command's own struct, which must have a
/// member `CommonOptions common`; it lives as long as the program. Call `finish_command` after the command's own
/// options, so that the common ones come last in the help.
CLI::App& add_command(Program& program, const CommandText& text);
void finish_command(Program& program, CLI::App& command, setup::CommonOptions& common, Action action);

/// One subcommand: `add` puts the options of a new Options on the line, `run` does the work with them.
template <typename Options>
void add_subcommand(Program& program, const CommandText& text, void (*add)(CLI::App&, Options&),
                    std::function<void(const Options&)> run) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = add_command(program, text);
  add(command, *options);
  finish_command(program, command, options->common, [options, run = std::move(run)] { run(*options); });
}

}  // namespace palpa::cli
