// Patterns: what their tables mean, and which are refused in one line.
#include "setup/files/pattern_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <utility>

#include "setup/files/assets.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::setup {
namespace {

void expect_at(const Vec3& place, double x, double y, double z) {
  EXPECT_LT(glm::distance(place, Vec3(x, y, z)), 1e-12) << place.x << " " << place.y << " " << place.z;
}

TEST(Assets, AreInTheirFolder) {
  EXPECT_NO_THROW(find_asset("cube.glb"));
  EXPECT_NO_THROW(find_asset("rigs/../cube.glb"));
  const std::string elsewhere = test::source_file("README.md").string();
  for (const std::string& name : {elsewhere, std::string("/etc/hostname"), std::string("../README.md"),
                                  std::string("rigs/../../README.md"), std::string("..")})
    EXPECT_REFUSED(find_asset(name), name + ": leads out of palpa's assets folder");
  EXPECT_ERROR(find_asset(""), Exit::usage, "the name of a file in palpa's assets folder is missing, such as cube.glb");
}

TEST(PatternFile, PointsAreInTheFilesOrderRelativeToTheLoudest) {
  const Pattern pattern = parse_pattern(R"(
    name = "two"
    [[point]]
    position_m = [0.01, 0, 0.15]
    amplitude = 2
    [[point]]
    position_m = [0, 0, 0.15]
    amplitude = 0
    radius_m = 0.001
    [[point]]
    position_m = [-0.01, 0, 0.15]
  )",
                                        "two.toml");
  EXPECT_EQ(pattern.name, "two");
  ASSERT_EQ(pattern.points.size(), 2u);
  expect_at(pattern.points[0].position, 0.01, 0, 0.15);
  EXPECT_EQ(pattern.points[0].amplitude, 1);
  EXPECT_EQ(pattern.points[1].amplitude, 0.5F);
  ASSERT_EQ(pattern.nulls.size(), 1u);
  EXPECT_EQ(pattern.nulls[0].radius_m, 0.001);
}

TEST(PatternFile, CurvesHavePointsAtEqualDistances) {
  const std::string square = "[[curve]]\ncorners_m = [0,0,0.1, 0.02,0,0.1, 0.02,0.02,0.1, 0,0.02,0.1]\n";
  const Pattern closed = parse_pattern(square + "points = 8\nclosed = true", "square.toml");
  EXPECT_EQ(closed.name, "square");
  ASSERT_EQ(closed.points.size(), 8u);
  expect_at(closed.points[0].position, 0, 0, 0.1);
  expect_at(closed.points[1].position, 0.01, 0, 0.1);
  expect_at(closed.points[5].position, 0.01, 0.02, 0.1);
  expect_at(closed.points[7].position, 0, 0.01, 0.1);
  const Pattern open = parse_pattern(square + "points = 4\namplitude = 0.5", "square.toml");
  ASSERT_EQ(open.points.size(), 4u);
  expect_at(open.points[3].position, 0, 0.02, 0.1);
  EXPECT_EQ(open.points[3].amplitude, 1) << "relative to the loudest";
}

TEST(PatternFile, PlanesHaveRowsFromTheTop) {
  const Pattern pattern = parse_pattern(R"(
    [[plane]]
    centre_m = [0, 0, 0.15]
    right_m = [0.01, 0, 0]
    up_m = [0, 0.02, 0]
    rows = ["#.5", "0.."]
  )",
                                        "plane.toml");
  ASSERT_EQ(pattern.points.size(), 2u);
  expect_at(pattern.points[0].position, -0.01, 0.01, 0.15);
  expect_at(pattern.points[1].position, 0.01, 0.01, 0.15);
  EXPECT_EQ(pattern.points[1].amplitude, 0.5F);
  ASSERT_EQ(pattern.nulls.size(), 1u);
  expect_at(pattern.nulls[0].position, -0.01, -0.01, 0.15);
}

/// docs/patterns.md says what they are: points that sound, and silent ones.
TEST(PatternFile, ReadsPalpasOwnPatterns) {
  const std::map<std::string, std::pair<std::size_t, std::size_t>> own{
      {"carter", {8, 9}}, {"gavrilov", {8, 0}}, {"hasegawa", {14, 0}}, {"hoshi", {12, 0}}, {"inoue", {49, 0}}};
  EXPECT_EQ(pattern_names().size(), own.size());
  for (const std::string& name : pattern_names()) {
    const Pattern pattern = load_pattern(test::source_file("assets/patterns/" + name + ".toml").string());
    EXPECT_EQ(pattern.name, name);
    ASSERT_TRUE(own.contains(name)) << name;
    EXPECT_EQ(pattern.points.size(), own.at(name).first) << name;
    EXPECT_EQ(pattern.nulls.size(), own.at(name).second) << name;
    Vec3 middle(0);
    for (const Pattern::Point& point : pattern.points) {
      EXPECT_EQ(point.amplitude, 1) << name;
      EXPECT_LE(glm::length(point.position), 0.013) << name;
      middle += point.position;
    }
    EXPECT_LT(std::hypot(middle.x, middle.z), 1e-4) << name << " is not around the finger";
  }
  EXPECT_REFUSED(load_pattern("hosh"),
                 "hosh: neither a file nor a known pattern; known: carter, gavrilov, hasegawa, hoshi, inoue");
  EXPECT_REFUSED(load_pattern("none.toml"), "none.toml");
}

TEST(PatternFile, RefusesWhatIsNoPattern) {
  const auto refused = [](const std::string& text, const std::string& why) {
    EXPECT_REFUSED(parse_pattern(text, "p.toml"), why);
    EXPECT_REFUSED(parse_pattern(text, "p.toml"), "p.toml: ");
  };
  const std::string point = "[[point]]\nposition_m = [0, 0, 0.15]\n";
  refused("", "no point sounds");
  refused(point + "amplitude = 0", "no point sounds");
  refused(point + "amplitude = -1", "amplitude");
  refused(point + "amplitude = nan", "amplitude");
  refused(point + "radius_m = 0.001", "radius_m goes with amplitude = 0");
  refused(point + "loudness = 1", "loudness");
  refused(point + point, "a second point is at (0, 0, 0.15) m");
  refused("[[point]]\nposition_m = [0, 0]", "position_m");
  refused("[[curve]]\ncorners_m = [0, 0, 0.1]\npoints = 4", "2 to 4096 corners");
  refused("[[curve]]\ncorners_m = [0,0,0.1, 0,0,0.1]\npoints = 4", "all corners at one place");
  refused("[[curve]]\ncorners_m = [0,0,0.1, 0.1,0,0.1]\npoints = 10000", "points");
  const std::string plane = "[[plane]]\ncentre_m = [0,0,0.1]\nright_m = [0.01,0,0]\nup_m = [0,0.01,0]\n";
  refused(plane + "rows = []", "rows is empty");
  refused(plane + "rows = ['##', '#']", "different lengths");
  refused(plane + "rows = ['#x']", "the letter 'x'");
  std::string many;
  for (int i = 0; i < 10'000; ++i)
    many += "[[point]]\nposition_m = [" + std::to_string(i * 1e-3) + ", 0, 0.15]\n";
  refused(many, "at most 64 points that sound and 64 that are silent");
  const std::string weak = "[[point]]\nposition_m = [0.02, 0, 0.15]\namplitude = ";
  refused(point + "amplitude = 1e6\n" + weak + "1e-300\n", "is nothing beside");
}

}  // namespace
}  // namespace palpa::setup
