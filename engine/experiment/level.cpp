#include "experiment/level.hpp"

#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "experiment/response_cache.hpp"
#include "experiment/touch_patterns.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::experiment {

namespace {

/// A single focus on the paper's cube.
struct ReferenceTouch {
  std::string file = setup::find_asset("cube.glb");
  std::vector<geometry::Solid> solids = setup::load_solids(file);
  double depth_m = 3e-3;
  study::PlanMethod method{.name = "single-focus", .method = touch::Method::single_focus, .stride = {}};
};

Calibration calibrate(ObservedFinger& finger, const array::Layout& layout, const ReferenceTouch& touch) {
  const ObservedMethod observed{touch.method, &layout};
  const Calibration calibration{
      touch_patterns(finger, {touch.file, touch.solids, touch.depth_m}, {}, {&observed, 1})[0].crest_n};
  if (!(calibration.linear_crest_n > 0))
    throw bad_input(finger.name(),
                    "gets no force from a single focus on the paper's cube at 3 mm, so that no level fits");
  return calibration;
}

}  // namespace

Calibration calibrate_level(ObservedFinger& finger, const array::Layout& layout) {
  return calibrate(finger, layout, {});
}

Calibration kept_level(ObservedFinger& finger, const array::Layout& layout) {
  const ReferenceTouch touch;
  const std::vector<double> depths{touch.depth_m}, none;
  const std::vector<observer::FingerPlace> places(1);
  const CacheKey key = key_of({finger, touch.solids, depths, places, none}, {touch.method, &layout});
  if (const std::optional<double> kept = load_number(key)) return {*kept};
  const Calibration calibration = calibrate(finger, layout, touch);
  store_number(key, calibration.linear_crest_n);
  return calibration;
}

}  // namespace palpa::experiment
