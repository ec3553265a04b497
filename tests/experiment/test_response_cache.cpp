// Responses that were computed for something else are not used again.
#include "experiment/response_cache.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"
#include "support/shared_data.hpp"

namespace palpa::experiment {
namespace {

TEST(ResponseCache, AllThatAResponseDependsOnGivesAnotherKey) {
  const ObservedFinger finger(setup::find_asset("finger.ply"));
  struct {
    std::vector<geometry::Solid> solids;
    std::vector<double> depths_m{1e-3}, factors{1};
    std::vector<observer::FingerPlace> places{{}};
    study::PlanMethod method;
    array::Layout layout = setup::load_posed_layout("paper");
  } now;
  now.solids = setup::load_solids(setup::find_asset("cube.glb"));
  const auto key = [&] {
    return key_of({finger, now.solids, now.depths_m, now.places, now.factors}, {now.method, &now.layout});
  };
  const CacheKey usual = key();
  const std::function<void()> changes[]{
      [&] { now.solids[0].mesh.positions[0].x += 1e-6; },
      [&] { now.depths_m[0] = 2e-3; },
      [&] { now.factors[0] = 2; },
      [&] { now.places[0].x_m = 1e-3; },
      [&] { now.places[0].z_m = 1e-3; },
      [&] { now.places[0].yaw_rad = 0.1; },
      [&] { now.method.method = touch::Method::ellipse; },
      [&] { now.method.foci = 9; },
      [&] { now.method.stride = 7; },
      [&] { now.method.dwell_s = 1e-3; },
      [&] { now.method.modulation_hz = 150; },
      [&] { now.method.delta_m = 1e-3; },
      [&] { now.layout.transducers[0].position.x += 1e-6; },
      [&] {
        now.layout.transducers[0].axis = {0, 1, 0};
      },
      [&] { now.layout.source_level_pa_m *= 2; },
      [&] { now.layout.transducer_radius_m *= 2; },
  };
  std::set<CacheKey> keys{key()};
  for (const auto& change : changes) {
    change();
    EXPECT_TRUE(keys.insert(key()).second) << "change " << keys.size();
  }
  EXPECT_NE(key(), usual);
}

}  // namespace
}  // namespace palpa::experiment
