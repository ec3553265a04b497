// What `palpa touch` computes: one touch of a scene by skin points or depth images, from contacts to the schedule of
// the foci, and what pressure an array gives at them. touch/stage.hpp names the paper's equations.
//
//   setup::TouchSceneOptions options{.array = {.layout = "paper"}};
//   setup::check(options, false);
//   std::vector<geometry::Solid> solids = setup::load_solids("cube.glb");
//   setup::TouchInput skin = setup::skin_points("my skin", points);
//   setup::TouchResult result = setup::touch_scene(options, "cube.glb", std::move(solids), skin);
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "geometry/solid.hpp"
#include "session/session.hpp"
#include "setup/options.hpp"
#include "setup/touch_input.hpp"
#include "setup/touch_run.hpp"
#include "touch/types.hpp"

namespace palpa::setup {

/// How a touch is found and what is asked about it. The defaults are the command line's.
struct TouchSceneOptions {
  ComputeOptions compute;
  TouchOptions touch;
  FeltOptions felt;
  ArrayOptions array;  ///< without a layout nothing sounds
};
/// Throws bad_usage where the options do not go together, and warns of what is unusual; `depth_images`: the skin comes
/// from these, which alone heed a finger's width.
void check(const TouchSceneOptions& options, bool depth_images);

/// A touch and what was asked about it. Lengths in metres, coordinates in the world.
struct TouchResult {
  OneTouch one;
  std::uint64_t points = 0;                    ///< skin points that were looked at, of depth images the valid pixels
  std::vector<acoustics::Spectrum> spectra;    ///< with FeltOptions::spectrum one for each finger, else none
  std::vector<std::vector<double>> pressures;  ///< Pa, with a layout: for each finger, for each focus of its voice
  std::optional<std::string> unreached;        ///< a sentence about a pressure that was asked for and is not reached
  double total_ms = 0;
  StepTimes times;

  const touch::Touch& touch() const { return one.touch; }  ///< contacts and fingers
  /// Foci and schedule (a voice for each finger), solids and setting.
  const session::Session& session() const { return one.session; }
  /// Whether --tune or its solid gave this finger a schedule of its own.
  bool has_own_schedule(std::uint32_t finger) const;
  /// Whether some focus has more than linear acoustics knows of: array::linear_pressure_pa.
  bool beyond_linear() const;
};

/// Skin touches the solids, of which `scene` is the file. Where nothing is touched there are no contacts and no
/// fingers, which is no error. `options` have passed check(). Times count from `since`, so that they include what was
/// loaded before. Warns of more fingers than are played. Throws bad_input for a layout, bad_usage for options that do
/// not fit the scene, else as touch_once does.
TouchResult touch_scene(const TouchSceneOptions& options, const std::string& scene, std::vector<geometry::Solid> solids,
                        const TouchInput& skin, Stopwatch since = {});

/// As `palpa touch --json` writes it (docs/files.md). Only `timing_ms` differs between runs.
std::string to_json(const TouchResult& result);
/// The contacts, a line each: index,x,y,z,depth,finger,solid; finger -1 where their cluster was too small.
std::string to_csv(const TouchResult& result);

}  // namespace palpa::setup
