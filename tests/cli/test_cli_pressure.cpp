// How loud foci are: `palpa touch --layout`, and the pressure that is asked for, as the real program has them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "array/directivity.hpp"
#include "array/layout.hpp"
#include "array/medium.hpp"
#include "process.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

[[maybe_unused]] const int assets_are_known = setenv("PALPA_ASSETS", source_file("assets").c_str(), 1);

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

std::vector<std::string> touch(const std::vector<std::string>& more) {
  return with({"touch", "--scene", asset("cube.glb"), "--points", asset("finger.ply"), "--penetration", "3mm",
               "--backend", "cpu"},
              more);
}

json document(const std::vector<std::string>& more) {
  const Result result = palpa(with(touch(more), {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

array::Layout posed(const std::string& name) {
  const array::Layout layout = array::load_layout(name);
  return array::transformed(layout, layout.default_T_world_layout);
}

Vec3 point(const json& three) {
  return {three[0].get<double>(), three[1].get<double>(), three[2].get<double>()};
}

/// What the paper's q_k gives at its focus: every transducer arrives in phase.
double alone_pa(const array::Layout& layout, const Vec3& focus) {
  double reach = 0, sum = 0;
  for (const auto& [place, axis] : layout.transducers)
    reach = std::max(reach, glm::distance(place, focus));
  for (const auto& [place, axis] : layout.transducers) {
    const Vec3 way = focus - place;
    const double d = glm::length(way);
    sum += d / reach * array::directivity(array::Directivity::t4010a1, glm::dot(way, axis) / d, 0) / d;
  }
  return layout.source_level_pa_m * sum;
}

TEST(CliPressure, ATouchTellsWhatAnArrayGivesAtItsFoci) {
  const json bare = document({});
  EXPECT_FALSE(bare["fingers"][0].contains("pressure_pa"));
  for (const std::string name : {"paper", "openmpd"}) {
    const array::Layout layout = posed(name);
    const json finger = document({"--layout", name})["fingers"][0];
    EXPECT_EQ(finger["foci_m"], bare["fingers"][0]["foci_m"]);
    const auto pressures = finger["pressures_pa"].get<std::vector<double>>();
    ASSERT_EQ(pressures.size(), 10u);
    for (std::size_t j = 0; j < pressures.size(); ++j) {
      const double expected = alone_pa(layout, point(finger["foci_m"][j]));
      EXPECT_NEAR(pressures[j], expected, 1e-4 * expected) << name << " focus " << j;
    }
    EXPECT_EQ(finger["pressure_pa"], *std::ranges::min_element(pressures));
  }
}

TEST(CliPressure, OfAnEmptySectorThereIsNone) {
  // A finger at the cube's edge: some of its sectors have no contacts.
  const json touched = document({"--layout", "openmpd", "--foci", "40", "--min-points", "1"});
  for (const json& finger : touched["fingers"]) {
    ASSERT_EQ(finger["pressures_pa"].size(), finger["foci_m"].size());
    for (std::size_t j = 0; j < finger["foci_m"].size(); ++j)
      EXPECT_EQ(finger["pressures_pa"][j].is_null(), finger["foci_m"][j].is_null());
  }
}

TEST(CliPressure, HowAnArrayIsDrivenGoesWithOne) {
  expect_failure(palpa(touch({"--solver", "greedy"})), 2, "--layout");
  expect_failure(palpa(touch({"--layout", "nowhere"})), 4, "nowhere");
}

}  // namespace
}  // namespace palpa::test
