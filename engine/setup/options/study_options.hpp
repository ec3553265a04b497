// The options of a participant's sitting in front of an array. `palpa study run` and `palpa-viewer --study` have the
// same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "setup/options/options.hpp"

namespace palpa::setup {

/// For a palpa that was built without SDL2, which plays noise in headphones.
inline constexpr const char* how_to_get_sdl2 = "install libsdl2-dev (./dev deps audio) and build palpa again";

/// The eyes of a participant, and the barrier of an autostereoscopic screen.
struct EyesOptions {
  double eyes_apart_m = 63e-3;
  std::optional<double> barrier_pitch_m, barrier_gap_m;  ///< by default, those with which neighbours differ
  double barrier_phase = 0;
};
void add_eyes_options(const line::Group& group, EyesOptions& options);

struct StudyRunOptions : EyesOptions {
  CommonOptions common;
  std::string plan;  ///< file
  std::optional<std::uint32_t> participant;
  std::string out;           ///< folder of the study
  std::string source, link;  ///< as those of palpa run; a rehearsal has synthetic and null if they are empty
  std::string rig, board_files;
  double hold_s = 0.1;
  bool hold_auto = false;
  std::string override_by;         ///< who accepts a level above the plan's limit
  std::optional<double> rehearse;  ///< a scripted participant with this share of right answers
  std::string monitor;             ///< name or number of the participant's; empty: the last, if there are several
  std::string size;                ///< "1280x720": of the participant's window, which then fills no monitor
  std::string stereo;  ///< how the pictures of two eyes become one, as --stereo of palpa-viewer; empty: none
};

/// Adds --override.
void add_override(const line::Group& group, std::string& who);
/// Adds all of them but the plan.
void add_study_run_options(CLI::App& app, StudyRunOptions& options);
/// Throws bad_usage if options are missing or exclude each other. Chooses source and link of a rehearsal.
void check(StudyRunOptions& options);

/// "1280x800": width and height, 16 to 8192 each. Throws bad_usage naming the option.
struct WindowSize {
  std::uint32_t width = 0, height = 0;
};
WindowSize parse_window_size(const std::string& option, const std::string& text);

}  // namespace palpa::setup
