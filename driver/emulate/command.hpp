// `palpa emulate BOARD`: a board made of software, for whoever has none, or none to spare.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "setup/options.hpp"

namespace palpa::driver::emulate {

/// What is given on the line; each board takes what applies to it.
struct Options {
  setup::CommonOptions common;
  std::string board;
  std::string serials;  ///< comma-separated
  std::string files;    ///< folder with the boards' own calibration
  std::string layout;   ///< empty: the board's usual one
  std::string trace;
  bool view = false;
};

struct Kind {
  std::string name;
  std::string help;
  /// Until a signal asks for the end. Throws failure() where anything spoke to it against its rules.
  std::function<void(const Options&)> run;
};
std::vector<Kind> kinds();

/// Puts it on the command line.
void add_emulate(cli::Program& program);

}  // namespace palpa::driver::emulate
