// Shared by the two parts of `palpa calibrate`: the poses of cameras, and --nudge.
#pragma once

#include <string>

#include "cli/command.hpp"
#include "sensing/rig.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::cli {

/// The options of both parts; a nudge is a live run.
struct CalibrateCommand : setup::LiveOptions {
  CalibrateCommand() { source.clear(); }  // if not given: a rehearsal

  std::string target;  ///< model to write
  std::string out;     ///< rig to write
  std::string at;      ///< place of the target, if not on its mount
  double turn_deg = 0;
  bool background = false;  ///< learn what cameras see without a hand
  bool nudge = false;
  std::string keys;
};

/// `palpa calibrate --nudge`. Without it, the others of these options are refused.
void add_nudge_options(CLI::App& app, CalibrateCommand& options);
void run_nudge(const Extensions& extensions, const CalibrateCommand& options);

}  // namespace palpa::cli
