// Euclidean clusters against region growing over nanoflann's k-d tree: a different structure, a different traversal,
// and code of other people. Random and adversarial clouds, with their points in any order.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <map>
#include <nanoflann.hpp>
#include <numeric>
#include <stdexcept>

#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using Points = std::vector<glm::vec3>;
using Clusters = std::vector<std::vector<std::uint32_t>>;  ///< each ascending, ordered by their first

/// What nanoflann asks of a cloud.
struct Cloud {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;

/// Collects what a search meets. nanoflann's own collectors have other types in 1.4 than from 1.5 on; what it asks of
/// one is the same.
struct Near {
  using DistanceType = double;

  double square;
  std::vector<std::uint32_t> found;

  bool addPoint(double distance, std::uint32_t index) {
    if (distance < square) found.push_back(index);
    return true;
  }
  std::size_t size() const { return found.size(); }
  bool empty() const { return found.empty(); }
  bool full() const { return true; }
  double worstDist() const { return square; }
  void sort() {}
};

/// Grows one region after the other. The tree gives candidates in double precision, a little too many; whether two
/// contacts are together is decided as the contract states it.
Clusters grow_regions(const Points& points, double gap_m, std::uint32_t least) {
  const float gap = static_cast<float>(gap_m), limit = gap * gap;
  const Cloud cloud{points};
  Tree tree(3, cloud);
  tree.buildIndex();
  Clusters clusters;
  std::vector<bool> taken(points.size(), false);
  for (std::uint32_t seed = 0; seed < points.size(); ++seed) {
    if (taken[seed]) continue;
    std::vector<std::uint32_t> region{seed};
    taken[seed] = true;
    for (std::size_t next = 0; next < region.size(); ++next) {
      const glm::vec3 from = points[region[next]];
      const std::array<double, 3> query{from.x, from.y, from.z};
      Near near{double{limit} * (1 + 1e-6), {}};
      tree.radiusSearchCustomCallback(query.data(), near);
      for (const std::uint32_t i : near.found) {
        const glm::vec3 d = points[i] - from;
        if (taken[i] || d.x * d.x + d.y * d.y + d.z * d.z > limit) continue;
        taken[i] = true;
        region.push_back(i);
      }
    }
    std::sort(region.begin(), region.end());
    if (region.size() >= least) clusters.push_back(std::move(region));
  }
  return clusters;
}

Clusters clusters_of(const Touch& touch) {
  Clusters clusters;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f)
    clusters.push_back(touch.fingers[f].contacts);
  return clusters;
}

/// Both find the same; of more than max_fingers the largest are compared, and how many there are.
void expect_regions(Backend backend, const Points& points, double gap, std::uint32_t least) {
  const Touch touch = touch_on(backend, points, {everything()}, everything_is_contact(gap, least));
  RC_ASSERT(touch.contacts.size() == points.size());
  Clusters expected = grow_regions(points, gap, least);
  RC_ASSERT(touch.cluster_count == expected.size());
  RC_ASSERT(clusters_of(touch) == largest(std::move(expected)));
}

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
    const auto least = *rc::gen::inRange(1U, 7U);
    expect_regions(GetParam(), drawn_cloud(gap, most()), gap, least);
  }));
}

TEST(AdversarialClouds, AllLieWithinEverythingAndAThreadIsOneCluster) {
  for (const double gap : {1e-3, 5e-3, 0.0794}) {
    for (const std::uint32_t count : {1U, 2U, 127U, 1000U, gap > 0.01 ? 1000U : 4000U}) {
      for (int kind = 0; kind < kinds; ++kind)
        EXPECT_EQ(adversarial(kind, count, gap, count + 1).size(), count) << kind;
      const Clusters whole = grow_regions(adversarial(2, count, gap, 1), gap, 1);
      ASSERT_EQ(whole.size(), 1U) << gap << ' ' << count;
      EXPECT_EQ(whole[0].size(), count);
    }
  }
}

TEST_P(ClustersAgainstNanoflann, FindTheSamePartitionOfEveryAdversary) {
  for (int kind = 0; kind < kinds; ++kind) {
    for (const std::uint32_t count : {1U, 127U, 4000U}) {
      const Points points = adversarial(kind, count, 5e-3, count + 1);
      const Touch touch = touch_on(GetParam(), points, {everything()}, everything_is_contact(5e-3, 3));
      Clusters expected = grow_regions(points, 5e-3, 3);
      ASSERT_EQ(touch.cluster_count, expected.size()) << kind << ' ' << count;
      EXPECT_EQ(clusters_of(touch), largest(std::move(expected))) << kind << ' ' << count;
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
      Clusters clusters = touch.cluster_count > max_fingers ? Clusters{} : clusters_of(touch);
      for (auto& cluster : clusters) {
        for (std::uint32_t& i : cluster)
          i = index(i);
        std::sort(cluster.begin(), cluster.end());
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
