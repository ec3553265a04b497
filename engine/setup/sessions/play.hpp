// `palpa play`: a sensation on an array, or as a table and a picture. Also for Python and the viewer.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/files/outputs.hpp"
#include "drawing/png.hpp"
#include "sensation/played.hpp"
#include "session/links/link.hpp"
#include "session/sensation_run.hpp"
#include "setup/sessions/hand_follower.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::setup {

/// It uses common, scene, source, rig, drive, safety, the hold, and what concerns the link and OSC.
struct PlayOptions : LiveOptions {
  PlayOptions() {
    source.clear();
    drive.weighting = array::Weighting::uniform;
  }
  std::vector<std::string> names;       ///< one: a file, or one of palpa's own
  std::vector<std::string> parameters;  ///< "NAME=VALUE"
  double speed = 1;
  std::string at;  ///< "x,y,z"
  std::optional<On> on;
  bool upright = false;
  std::optional<double> duration_s, dwell_s;
  std::string png, csv;
};
void add_play_options(CLI::App& app, PlayOptions& options);
/// The option of a pattern's parameters.
void add_parameters(const line::Group& group, std::vector<std::string>& parameters);
/// Throws bad_usage for options that are missing or do not go together.
void check(const PlayOptions& options);
/// Whether it only writes files, not in real time.
bool is_offline(const PlayOptions& options);
std::vector<Output> outputs_of(const PlayOptions& options, std::span<const session::LinkKind> links);

/// palpa's own sensations (assets/sensations, docs/sensations.md).
std::vector<std::string> sensation_names();
/// The pattern of that name, or in that file. Throws bad_input also for a name that is neither.
sensation::Pattern load_sensation(const std::string& name_or_file);
/// Throws bad_usage for a name that the pattern does not know. Warns of a value beyond its limits. `where`: how
/// messages begin.
void check_parameter(const std::string& where, const std::string& name, double value,
                     const sensation::Pattern& pattern);
/// Values from "NAME=VALUE" of --param, checked. Throws bad_usage for another form, too.
std::map<std::string, double> parameters_of(std::span<const std::string> texts, const sensation::Pattern& pattern);

/// At least so many slots in one turn of the fastest brush or modulation.
inline constexpr double slots_in_a_turn = 16;
/// A sensation that is slow or stands still has slots of this length.
inline constexpr double longest_own_slot_s = 1.5e-3;
/// The limits of --dwell.
inline constexpr double least_slot_s = 50e-6, most_slot_s = 50e-3;
/// The longest slot of whole periods that gives slots_in_a_turn. At most longest_own_slot_s, at least one period.
double usual_slot(double fastest_hz, double period_s);

/// The frequency again. Throws bad_input if it is above sensation::most_hz; `who` is the sensation in messages.
double playable(double fastest_hz, const std::string& who);

/// Where and how it plays: everything but the sensation itself.
struct Playing {
  PlacedLayout placed;
  array::Layout posed;
  session::SensationSetting setting;  ///< refers to `posed`
  Playing(PlacedLayout array, const PlayOptions& options);
  Playing(const Playing&) = delete;
  Playing& operator=(const Playing&) = delete;
};
/// Chooses the slot and whether plans list drives, with warnings where the link is too slow. Throws as playable() and
/// as the link does.
std::unique_ptr<Playing> prepare_play(const PlayOptions& options, double fastest_hz, const std::string& who,
                                      std::span<const session::LinkKind> links);

/// The most slots in a table, a picture or a record, and the longest time.
inline constexpr std::uint64_t most_offline_slots = 500'000;
inline constexpr double most_offline_s = 1000;
/// The slots until its stop or its duration, for files. Throws bad_usage if there are more than most_offline_slots, or
/// if it plays for longer than most_offline_s.
std::vector<sensation::Point> offline_points(sensation::Sensation& sensation, const session::SensationSetting& setting,
                                             const std::string& who);
/// time_s,x_m,y_m,z_m,gain: the point at each slot's beginning, in the array's frame.
std::string sensation_csv(std::span<const sensation::Point> points, const session::SensationSetting& setting);
drawing::Pixels sensation_picture(std::span<const sensation::Point> points, const session::SensationSetting& setting,
                                  const std::string& title);

/// Plays it live, or these points into a record. Throws as opening the link and the source do, and as the run does.
session::OutputStats play(const PlayOptions& options, sensation::Sensation& sensation,
                          session::SensationControl& control, Playing& playing,
                          std::span<const sensation::Point> offline, std::span<const session::SourceKind> sources,
                          std::span<const session::LinkKind> links, std::atomic<bool>& stop);

}  // namespace palpa::setup
