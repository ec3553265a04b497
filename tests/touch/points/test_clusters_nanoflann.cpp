// Euclidean clusters against region growing over nanoflann's k-d tree: random and adversarial clouds, with their points
// in any order.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <numeric>
#include <stdexcept>

#include "touch/harness.hpp"
#include "touch/points/regions.hpp"

namespace palpa::touch::test {
namespace {

using Points = std::vector<glm::vec3>;

/// `count` points along a helix of at most 1.2 m radius and 1.5 m rise, 0.98 of a gap apart each. Its turns lie further
/// apart than a gap where there are more than 230 points: a single cluster, however long.
Points thread(std::uint32_t count, double gap) {
  const double step = 0.98 * gap, radius = std::min(step * count / 25, 1.2);
  const double rise = std::min(2e-3 * count * radius, 1.5) / count;
  const double turn = std::sqrt(step * step - rise * rise) / radius;
  Points points;
  for (std::uint32_t i = 0; i < count; ++i)
    points.emplace_back(Vec3(radius * std::cos(turn * i), rise * i, radius * std::sin(turn * i)));
  return points;
}

/// Clouds that are hard on cells, trees or union-find; `kind` names one. All lie within everything().
Points adversarial(int kind, std::uint32_t count, double gap, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto anywhere = [&] {
    const double x = unit(random), y = unit(random), z = unit(random);
    return Vec3(x, y, z);
  };
  Points points = kind == 2 ? thread(count, gap) : Points{};
  for (auto i = static_cast<std::uint32_t>(points.size()); i < count; ++i) {
    switch (kind) {
      case 0:  // about as many neighbours as make long, branching clusters
        points.emplace_back(anywhere() * gap * std::cbrt(count * 0.19));
        break;
      case 1:  // a lattice exactly, or hardly not, a gap apart
        points.emplace_back(gap * (1 + (seed % 3) * 1e-7) * Vec3(i % 9, i / 9 % 9, i / 81));
        break;
      case 3:  // many contacts in few places, some in the very same
        points.emplace_back(gap * 1.02 * glm::floor(anywhere() * 3.0) + 0.01 * gap * glm::floor(anywhere() * 4.0));
        break;
      case 4:  // two shells, one in the other, nearly a gap apart
        points.emplace_back(glm::normalize(anywhere()) * gap * (i % 2 == 0 ? 2.0 : 2.999 + 0.002 * unit(random)));
        break;
      case 5:  // dense balls on a line, each pair joined or not by a single contact
        points.emplace_back(i % 97 == 0 ? Vec3(gap * unit(random) * 12, 0, 0)
                                        : gap * (Vec3(1.9 * (i % 13) - 12, 0, 0) + 0.3 * anywhere()));
        break;
      default:  // far from the solid's centre, in the corners of cells
        points.emplace_back(Vec3(1.6, -1.6, 1.6) + 0.52 * gap * glm::floor(anywhere() * 6.0) + 1e-7 * anywhere());
        break;
    }
  }
  const geometry::Solid solid = everything();
  for (const Vec3 p : points) {  // no point beyond it is a contact: neither clusters nor their order would compare
    if (glm::any(glm::lessThanEqual(p, solid.bounds.low)) || glm::any(glm::greaterThanEqual(p, solid.bounds.high)))
      throw std::logic_error(
          fmt::format("cloud {} of {} points, gap {}: ({}, {}, {}) is outside", kind, count, gap, p.x, p.y, p.z));
  }
  std::shuffle(points.begin(), points.end(), random);
  return points;
}
constexpr int kinds = 7;

Points drawn_cloud(double gap, std::uint32_t most) {
  const auto kind = *rc::gen::element(0, 1, 2, 3, 4, 5, 6);
  const auto count = *rc::gen::inRange(1U, most);
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  return adversarial(kind, count, gap, seed);
}

class ClustersAgainstNanoflann : public OnBothBackends {
 protected:
  std::uint32_t most() const { return GetParam() == Backend::cpu ? 1000 : 400; }
};
INSTANTIATE_TEST_SUITE_P(, ClustersAgainstNanoflann, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

TEST_P(ClustersAgainstNanoflann, FindTheSamePartition) {
  EXPECT_TRUE(rc::check([&] {
    const double gap = std::pow(10.0, *rc::gen::inRange(-30, -10) / 10.0);  // 1 to 79 mm
    const FingerOptions parameters = everything_is_contact(gap, *rc::gen::inRange(1U, 7U));
    const Points points = drawn_cloud(gap, most());
    const Touch touch = touch_on(GetParam(), points, {everything()}, parameters);
    RC_ASSERT(touch.contacts.size() == points.size());
    RC_ASSERT(not_regions(touch, parameters) == "");
  }));
}

TEST_P(ClustersAgainstNanoflann, FindTheSamePartitionOfEveryAdversary) {
  const FingerOptions parameters = everything_is_contact(5e-3, 3);
  for (int kind = 0; kind < kinds; ++kind) {
    for (const std::uint32_t count : {1U, 127U, 4000U}) {
      const Touch touch = touch_on(GetParam(), adversarial(kind, count, 5e-3, count + 1), {everything()}, parameters);
      EXPECT_EQ(not_regions(touch, parameters), "") << kind << ' ' << count;
    }
  }
}

TEST_P(ClustersAgainstNanoflann, APermutationOfThePointsPermutesThePartition) {
  EXPECT_TRUE(rc::check([&] {
    const double gap = 4e-3;
    const Points points = drawn_cloud(gap, most());
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::shuffle(order.begin(), order.end(), std::mt19937(*rc::gen::arbitrary<std::uint32_t>()));
    Points shuffled;
    for (const std::uint32_t i : order)
      shuffled.push_back(points[i]);
    const auto sets = [&](const Points& cloud, auto&& index) {
      const Touch touch = touch_on(GetParam(), cloud, {everything()}, everything_is_contact(gap, 1));
      // Which clusters are beyond the most depends on the order: then only their number counts.
      Regions clusters(touch.cluster_count > max_fingers ? 0 : touch.finger_count);
      for (std::size_t f = 0; f < clusters.size(); ++f) {
        for (const std::uint32_t i : touch.fingers[f].contacts)
          clusters[f].push_back(index(i));
        std::sort(clusters[f].begin(), clusters[f].end());
      }
      std::sort(clusters.begin(), clusters.end());
      return std::pair(touch.cluster_count, clusters);
    };
    RC_ASSERT(sets(points, [](std::uint32_t i) { return i; }) ==
              sets(shuffled, [&](std::uint32_t i) { return order[i]; }));
  }));
}

}  // namespace
}  // namespace palpa::touch::test
