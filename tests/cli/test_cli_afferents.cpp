// `palpa afferents` with a small finger and an array of few transducers.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

class CliAfferents : public testing::Test {
 protected:
  CliAfferents() {
    const geometry::Mesh tip = transformed(sphere(2e-3, 8, 12), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); });
    geometry::write_ply(tip_, tip.positions, tip.triangles);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const std::filesystem::path folder_ = scratch_folder("afferents");
  const std::string tip_ = path("tip.ply"), cube_ = source_file("assets/cube.glb");
  const std::vector<std::string> line_{"afferents", "--scene",  cube_,          "--finger",   tip_, "--layout",
                                       "openmpd",   "--method", "single-focus", "--duration", "0.2"};
};

TEST_F(CliAfferents, TimesAndMapAreOfTheSameSpikes) {
  const Result result =
      palpa_here(with(line_, {"--penetration", "1mm", "--crest", "200", "--json", "-", "--times", path("times.csv"),
                              "--csv", path("sites.csv"), "--png", path("spikes.png")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json all = json::parse(result.out);
  EXPECT_EQ(all["spikes"].size(), 40u);
  double in_time = 0, on_map = 0, area = 0;
  for (const json& bin : all["spikes"])
    in_time += bin["pc"].get<double>();
  for (const json& site : all["sites"]) {
    area += site["area_cm2"].get<double>();
    on_map += site["rates_hz"]["pc"].get<double>() * site["area_cm2"].get<double>() * 25 * 0.2;
  }
  EXPECT_GT(in_time, 0);
  EXPECT_NEAR(in_time, on_map, 1e-6 * on_map);
  // At 200 Hz, no model of PC fires more than twice in a period for long.
  EXPECT_LE(in_time, 1.1 * 400 * 0.2 * area * 25);
  EXPECT_NEAR(all["afferents"]["pc"].get<double>(), 25 * area, 1e-6);
  EXPECT_NEAR(all["afferents"]["ra"].get<double>(), 140 * area, 1e-6);
  EXPECT_TRUE(read_text(path("times.csv")).starts_with("time_s,sa1,ra,pc\n0,"));
  EXPECT_TRUE(read_text(path("sites.csv")).starts_with("site,x,y,z,area_cm2,sa1_hz,ra_hz,pc_hz\n0,"));
  EXPECT_TRUE(std::filesystem::exists(path("spikes.png")));
}

TEST_F(CliAfferents, TheLevelIsThatOfASingleFocusOnTheCube) {
  const auto run = [&](const std::vector<std::string>& more) {
    const Result result = palpa_here(with(line_, with({"--penetration", "3mm", "--json", "-"}, more)));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  };
  const json usual = run({}), louder = run({"--crest", "40"}), linear = run({"--linear"});
  EXPECT_NEAR(usual["crest_n"].get<double>(), 16e-3, 1e-9);
  EXPECT_NEAR(louder["crest_n"].get<double>(), 40e-3, 1e-9);
  EXPECT_EQ(linear["factor"], 1);
  EXPECT_NEAR(usual["factor"].get<double>() * linear["crest_n"].get<double>(), 16e-3, 1e-9);
}

TEST_F(CliAfferents, BadInputIsOneLine) {
  expect_failure(palpa_here({"afferents"}), 2, "--scene is missing");
  expect_failure(palpa_here(with(line_, {"--x", "0.5"})), 4, "touches nothing");
  expect_failure(palpa_here(with(line_, {"--bin", "1"})), 2, "--bin is longer than --duration");
  expect_failure(palpa_here({"afferents", "--scene", cube_, "--foci", "10", "--stride", "5"}), 2, "--stride");
}

}  // namespace
}  // namespace palpa::test
