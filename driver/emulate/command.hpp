// `palpa emulate BOARD`: an emulated board, for users who have no board, or none to spare.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/outputs.hpp"
#include "cli/command.hpp"
#include "driver/emulate/violations.hpp"
#include "setup/options/options.hpp"

namespace palpa::driver::emulate {

/// The port of an AUTD3 server.
inline constexpr std::uint32_t default_port = 8080;

/// The options on the command line. A board does not get an option that it has no use for: run() refuses it.
struct Options {
  setup::CommonOptions common;
  std::string board;
  std::string serials;                    ///< comma-separated
  std::string files;                      ///< folder with the boards' own calibration
  std::string layout;                     ///< empty: the board's usual one
  std::optional<std::uint32_t> port;      ///< normally default_port
  std::optional<std::uint64_t> protocol;  ///< of AUTD3 units on a network cable: 2, 3 or 5
  std::optional<double> processing_s;     ///< their time for a frame
  std::vector<std::string> faults;        ///< of their wire, in order
  bool tactile = false;
  bool uart = false;  ///< USB boards whose chips are set up as serial ports
  std::string trace;
  bool view = false;
};

/// Prints violations as they come, one line each, unless quiet. `told` of them have been printed.
void tell_violations(const Options& options, std::span<const Violation> all, std::size_t& told);
/// What an emulator of one server or line reports at its end: `summary` for people, the same in numbers as --json, and
/// a failure() if there were violations.
struct Outcome {
  std::string summary;
  std::string counted;      ///< what `count` counts
  std::uint64_t count = 0;  ///< how many have come
  bool sounds = false;
  std::span<const Violation> violations;  ///< the first of them
  std::size_t violation_count = 0;
};
void conclude(const Options& options, const Outputs& outputs, const Outcome& outcome);

struct Kind {
  std::string name;
  std::string help;
  /// Runs until a signal asks for the end. Throws failure() if anything broke the board's rules.
  std::function<void(const Options&, const Outputs&)> run;
  std::vector<std::string> options;  ///< of the options that only some boards use, those that this one uses
};
std::vector<Kind> kinds();

/// Puts the command `emulate` on the command line.
void add_emulate(cli::Program& program);

}  // namespace palpa::driver::emulate
