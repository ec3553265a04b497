#include "experiment/level.hpp"

#include <string>
#include <vector>

#include "base/error.hpp"
#include "experiment/touch_patterns.hpp"
#include "setup/assets.hpp"
#include "setup/load.hpp"

namespace palpa::experiment {

Calibration calibrate_level(ObservedFinger& finger, const array::Layout& layout) {
  constexpr double depth_m = 3e-3;
  const std::string file = setup::find_asset("cube.glb");
  const std::vector<geometry::Solid> solids = setup::load_solids(file);
  const study::PlanMethod method{.name = "single-focus", .method = touch::Method::single_focus, .stride = {}};
  const ObservedMethod observed{method, &layout};
  const Calibration calibration{touch_patterns(finger, {file, solids, depth_m}, {}, {&observed, 1})[0].crest_n};
  if (!(calibration.linear_crest_n > 0))
    throw bad_input(finger.name(),
                    "gets no force from a single focus on the paper's cube at 3 mm, so that no level fits");
  return calibration;
}

}  // namespace palpa::experiment
