// `palpa emulate BOARD`: a board made of software, for whoever has none, or none to spare.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/outputs.hpp"
#include "cli/command.hpp"
#include "driver/emulate/violations.hpp"
#include "setup/options.hpp"

namespace palpa::driver::emulate {

/// Of an AUTD3 server.
inline constexpr std::uint32_t usual_port = 8080;

/// What is given on the line. A board that has no use for an option does not get it: run() refuses it.
struct Options {
  setup::CommonOptions common;
  std::string board;
  std::string serials;                ///< comma-separated
  std::string files;                  ///< folder with the boards' own calibration
  std::string layout;                 ///< empty: the board's usual one
  std::optional<std::uint32_t> port;  ///< normally usual_port
  bool tactile = false;
  bool uart = false;  ///< USB boards whose chips are set up as serial ports
  std::string trace;
  bool view = false;
};

/// Violations as they come: a line each, unless quiet. `told` of them have been told.
void tell_violations(const Options& options, std::span<const Violation> all, std::size_t& told);
/// What an emulator of one server or line says at its end: `summary` for people, the same in numbers as --json, and a
/// failure() where there were violations.
struct Outcome {
  std::string summary;
  std::string counted;      ///< what `count` counts
  std::uint64_t count = 0;  ///< of what came
  bool sounds = false;
  std::span<const Violation> violations;  ///< the first of them
  std::size_t violation_count = 0;
};
void conclude(const Options& options, const Outputs& outputs, const Outcome& outcome);

struct Kind {
  std::string name;
  std::string help;
  /// Until a signal asks for the end. Throws failure() where anything spoke to it against its rules.
  std::function<void(const Options&, const Outputs&)> run;
  std::vector<std::string> options;  ///< those that only some boards heed, of which this one heeds these
};
std::vector<Kind> kinds();

/// Puts it on the command line.
void add_emulate(cli::Program& program);

}  // namespace palpa::driver::emulate
