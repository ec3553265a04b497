// The computation of `palpa calibrate --background`: what each of a rig's cameras sees without a hand
// (sensing/background.hpp), as images beside the rig that is written.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/files/outputs.hpp"
#include "sensing/background.hpp"
#include "sensing/rig.hpp"
#include "session/links/sources.hpp"
#include "setup/options/options.hpp"
#include "setup/tasks/calibrate.hpp"

namespace palpa::setup {

struct BackgroundTask : StillTask {  ///< at most 1000 frames, usually two seconds of the fastest camera
  std::string out;                   ///< the rig that is written; empty: none
};
/// Throws bad_usage, naming the command's options.
void check(const BackgroundTask& task);

/// The images that will be written beside the rig, one per camera: "RIG-CAMERA.png". Reads the rig.
std::vector<std::string> images_of(const BackgroundTask& task);

struct BackgroundOfCamera {
  std::string name;
  sensing::LearnedBackground learned;
  std::string file;  ///< empty if nothing is written
};
struct BackgroundResult {
  std::vector<BackgroundOfCamera> cameras;
  std::uint64_t frames = 0;  ///< number of frames taken
};
/// The output of `palpa calibrate --background --json` (docs/calibration.md).
std::string to_json(const BackgroundResult& result);

/// Learns the backgrounds and writes the images, then the rig. `sources` are added to palpa's own. Warns of a camera
/// that sees something move, or nothing at all. Throws as check, load_posed_rig, session::open_source and the writers
/// do; bad_input if rig and source have different cameras; failure for fewer than 10 frames.
BackgroundResult learn_background(const BackgroundTask& task, std::span<const session::SourceKind> sources,
                                  const CalibrateWatch& watch = {});

}  // namespace palpa::setup
