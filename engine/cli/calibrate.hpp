// Shared by the parts of `palpa calibrate`: the poses of cameras from a target, --nudge, and --by-touch.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "base/error.hpp"
#include "base/math.hpp"
#include "cli/command.hpp"
#include "sensing/rig.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/tasks/touch_steps.hpp"

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
  bool by_touch = false;  ///< the cameras' poses by foci that are touched; then `nudge` is true, too
  std::string keys;
};

/// `palpa calibrate --nudge`. Without it, the others of these options are refused.
void add_nudge_options(CLI::App& app, CalibrateCommand& options);
void run_nudge(const Extensions& extensions, const CalibrateCommand& options);
/// `palpa calibrate --by-touch`.
void run_by_touch(const Extensions& extensions, const CalibrateCommand& options);

/// Throws bad_usage, naming `mode`, without --out, and without both a terminal and keys.
void check_keys(const CalibrateCommand& options, const char* mode);

struct KeysEnd {
  bool saves = false;            ///< Enter was pressed, after the last focus; otherwise the user left
  Vec3 offset_m{0};              ///< of the focus that was moved
  std::optional<Error> fault{};  ///< of the link, after Enter
};
/// A live run whose foci the keys move. With `touches`, Enter goes from focus to focus. Throws failure, naming `mode`,
/// if the run ends before the user does.
KeysEnd run_with_keys(const CalibrateCommand& options, std::span<const session::SourceKind> sources,
                      std::span<const session::LinkKind> links, const char* mode, setup::TouchSteps* touches);

}  // namespace palpa::cli
