// The computation of `palpa touch`: one touch of a scene by skin points or depth images, from contacts to the schedule
// of the foci, and an array's pressures at the foci. touch/stage.hpp names the paper's equations.
//
//   setup::TouchTask options{.array = {.layout = "paper"}};
//   setup::check(options, false);
//   std::vector<geometry::Solid> solids = setup::load_solids("cube.glb");
//   setup::TouchInput skin = setup::skin_points("my skin", points);
//   setup::TouchResult result = setup::touch_scene(options, "cube.glb", std::move(solids), skin);
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/audible.hpp"
#include "acoustics/felt/spectrum.hpp"
#include "array/drive_options.hpp"
#include "array/schedule.hpp"
#include "base/files/json_rows.hpp"
#include "geometry/solid.hpp"
#include "session/plan/scheduler.hpp"
#include "session/session.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/sessions/touch_run.hpp"
#include "touch/types.hpp"

namespace palpa::setup {

/// The options for finding a touch and for its results. The defaults are the command line's.
struct TouchTask {
  ComputeOptions compute;
  TouchOptions touch;
  FeltOptions felt;
  HeardOptions heard;
  ArrayOptions array;               ///< without a layout, nothing sounds
  session::OwnMethod own_method{};  ///< instead of the touch's method
  /// Keeps what is prepared of the solids for the next touch of the same. Null: nothing is kept.
  std::shared_ptr<touch::KeptSolids> kept_solids{};
};
/// Adds the options that it has.
void add_task_options(CLI::App& app, TouchTask& options);
/// Throws bad_usage if the options do not fit together; warns of unusual values. `depth_images`: the skin comes from
/// depth images; a finger's width has an effect only with them.
void check(const TouchTask& options, bool depth_images);

/// The touch as it is heard beside the beam, a WAV file (acoustics::to_wav), with transducers of the lowest quality.
/// Warns of samples that are cut. Throws bad_usage if nothing sounds.
std::string wav_of(const TouchTask& options, const session::Session& session, double full_scale_db);

/// All values of a touch without its session, for those who keep many touches: a session has the solids and a device.
/// Lengths in metres, coordinates in the world.
struct TouchValues {
  touch::Touch touch;
  array::Schedule schedule;                       ///< a voice for each finger
  array::Voice common;                            ///< Scheduler::common_voice
  std::vector<session::ScheduledFinger> fingers;  ///< how each finger got its voice
  std::vector<std::string> solids;                ///< their names
  /// Whether --tune, its solid or a method of the caller's gave a finger its own schedule.
  std::vector<bool> own_schedule;
  std::uint64_t points = 0;                    ///< number of skin points; with depth images, of valid pixels
  std::vector<acoustics::Spectrum> spectra;    ///< with FeltOptions::spectrum, one for each finger; otherwise empty
  std::vector<std::vector<double>> pressures;  ///< Pa, with a layout: for each finger, for each focus of its voice
  std::optional<acoustics::EarLevel> ear;      ///< with HeardOptions::audible and a finger
  std::optional<array::DrivenBy> driven;       ///< with a layout: how its drives are computed
  std::optional<UsedBackend> computed;         ///< what computed, and why
  double total_ms = 0;
  StepTimes times;
};

/// A touch and the requested results.
struct TouchResult {
  OneTouch one;
  TouchValues values;
  std::optional<std::string> unreached;  ///< a sentence about a requested pressure that is not reached

  const touch::Touch& touch() const { return one.touch; }  ///< contacts and fingers
  /// Foci and schedule (a voice for each finger), solids and setting.
  const session::Session& session() const { return one.session; }
  /// Whether any focus has more pressure than linear acoustics holds for (array::linear_pressure_pa).
  bool beyond_linear() const;
};

/// The touch of the skin and the solids, whose file is `scene`. If nothing is touched, there are no contacts and no
/// fingers; that is not an error. `options` must have passed check(). Times are measured from `since`, so that they can
/// include earlier loading. Warns if there are more fingers than are played. Throws bad_input for an invalid layout,
/// bad_usage for options that do not fit the scene, otherwise as touch_once does.
TouchResult touch_scene(const TouchTask& options, const std::string& scene, std::vector<geometry::Solid> solids,
                        const TouchInput& skin, Stopwatch since = {});

/// The values of a frame of any session that works frame by frame: without points, spectra, pressures, backend and
/// times.
TouchValues values_of(const session::Session& session, const touch::Touch& touch);

/// The members of that JSON, in their order.
const JsonRows<TouchValues>& touch_rows();
/// The output of `palpa touch --json` (docs/touch.md). Only `timing_ms` differs between runs.
std::string to_json(const TouchValues& values);
/// The contacts, a line each: index,x,y,z,depth,finger,solid; finger is -1 if the cluster was too small.
std::string to_csv(const TouchValues& values);

}  // namespace palpa::setup
