#include "setup/experiment/level.hpp"

#include <string>
#include <vector>

#include "base/error.hpp"
#include "setup/assets.hpp"
#include "setup/experiment/touch_patterns.hpp"
#include "setup/load.hpp"

namespace palpa::setup {

Calibration calibrate_level(ObservedFinger& finger, const array::Layout& layout) {
  const std::string file = find_asset("cube.glb");
  const std::vector<geometry::Solid> solids = load_solids(file);
  const study::PlanMethod method{.name = "single-focus", .method = touch::Method::single_focus, .stride = {}};
  const ObservedMethod observed{method, &layout};
  const Calibration calibration{
      touch_patterns(finger, {file, solids, calibration_depth_m}, {}, {&observed, 1})[0].crest_n};
  if (!(calibration.linear_crest_n > 0))
    throw bad_input(finger.name(),
                    "gets no force from a single focus on the paper's cube at 3 mm, so that no level fits");
  return calibration;
}

}  // namespace palpa::setup
