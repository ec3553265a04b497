#include "touch/harness.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <utility>

#include "gpu/barrier.hpp"
#include "support/device.hpp"
#include "support/time_limits.hpp"

namespace palpa::touch::test {

using palpa::test::test_device;

std::string backend_name(const ::testing::TestParamInfo<Backend>& info) {
  return info.param == Backend::cpu ? "cpu" : "gpu";
}

std::vector<sensing::SkinPoint> indexed(const std::vector<glm::vec3>& points) {
  return sensing::numbered(points);
}

Passes& test_passes() {
  static Passes passes(test_device());
  return passes;
}

Touch touch_on_device(std::span<const sensing::SkinPoint> points, const std::vector<geometry::Solid>& solids,
                      const StageSetting& setting, int runs, std::vector<gpu::PassTime>* times) {
  DeviceStage stage(solids, {}, setting);
  Touch out;
  std::vector<gpu::PassTime> once;
  for (int run = 0; run < runs; ++run) {
    const Touch before = out;
    const double began_s = palpa::test::processor_s();
    stage.touch(points, out);
    const double took = (palpa::test::processor_s() - began_s) * 1e3;
    if (run > 0) expect_identical(before, out);
    if (times) {
      once.assign(stage.times().begin(), stage.times().end());
      once.push_back({"all threads' CPU time", took});
      if (run == 0) *times = once;
      for (std::size_t i = 0; i < once.size(); ++i)
        (*times)[i].ms = std::min((*times)[i].ms, once[i].ms);
    }
  }
  return out;
}

Touch touch_on(Backend backend, const std::vector<glm::vec3>& points, const std::vector<geometry::Solid>& solids,
               const FingerOptions& parameters, int gpu_runs) {
  if (backend == Backend::cpu) {
    Touch out;
    Stage(solids, {}, {.parameters = parameters}).touch(indexed(points), out);
    return out;
  }
  const auto count = static_cast<std::uint32_t>(points.size());
  return touch_on_device(indexed(points), solids,
                         {.parameters = parameters, .most_points = count, .most_contacts = count}, gpu_runs);
}

geometry::Solid cube() {
  return box({-0.02, -0.04, -0.02}, {0.02, 0, 0.02}, "cube");
}

geometry::Solid ball(const Vec3& centre, double radius, std::uint32_t count, const std::string& name) {
  geometry::Solid solid;
  solid.name = name;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::uint32_t i = 0; i < count; ++i) {
    const double y = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - y * y);
    const Vec3 normal(r * std::cos(golden * i), y, r * std::sin(golden * i));
    solid.planes.push_back({normal, glm::dot(normal, centre) + radius});
  }
  const double reach = radius * (1 + 8.0 / count);
  solid.bounds = {centre - reach, centre + reach};
  return solid;
}

geometry::Solid half_ball(const Vec3& centre, double radius, std::uint32_t count) {
  geometry::Solid solid = ball(centre, radius, 2 * count, "half ball");
  std::erase_if(solid.planes, [](const geometry::Plane& plane) { return plane.normal.y < 0; });
  solid.planes.push_back({{0, -1, 0}, -centre.y});
  solid.bounds.low.y = centre.y;
  return solid;
}

namespace {

/// Points of a finger whose tip is the origin. Films and both backends ask for the same fingers again and again.
const std::vector<Vec3>& finger_points(std::uint32_t count, unsigned seed) {
  static std::map<std::pair<std::uint32_t, unsigned>, std::vector<Vec3>> made;
  std::vector<Vec3>& points = made[{count, seed}];
  if (!points.empty()) return points;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const double radius = 8e-3, length = 50e-3;
  const double tip_share = radius / length;  // area of the half sphere against that of the whole finger
  for (std::uint32_t i = 0; i < count; ++i) {
    const double around = 2 * std::numbers::pi * unit(random);
    const double share = unit(random);
    const double along = share < tip_share ? unit(random) * radius : radius + unit(random) * (length - radius);
    const double wide = along < radius ? std::sqrt(radius * radius - (radius - along) * (radius - along)) : radius;
    points.emplace_back(wide * std::cos(around), along, wide * std::sin(around));
  }
  return points;
}

}  // namespace

std::vector<glm::vec3> fingertip(std::uint32_t count, double depth, double x, double z, unsigned seed, double highest) {
  std::vector<glm::vec3> points;
  for (const Vec3& p : finger_points(count, seed)) {
    if (p.y - depth <= highest) points.emplace_back(x + p.x, p.y - depth, z + p.z);
  }
  return points;
}

std::vector<glm::vec3> random_points(std::uint32_t count, const Vec3& low, const Vec3& high, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::vec3> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    points.emplace_back(low + (high - low) * Vec3(x, y, z));
  }
  return points;
}

geometry::Solid everything() {
  return box(Vec3(-2), Vec3(2), "everything");
}

FingerOptions everything_is_contact(double gap, std::uint32_t min_points) {
  return {.delta_m = 10, .finger_gap_m = gap, .min_points = min_points, .foci = 10};
}

std::vector<int> finger_of_contacts(const Touch& touch) {
  std::vector<int> finger(touch.contacts.size(), -1);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    for (const std::uint32_t i : touch.fingers[f].contacts)
      finger.at(i) = static_cast<int>(f);
  }
  return finger;
}

namespace {
template <typename T>
bool same_bits(const T& a, const T& b) {
  // Bit for bit on purpose, so that NaN equals NaN and 0 differs from -0; none of these structs has padding.
  return std::memcmp(&a, &b, sizeof(T)) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}
}  // namespace

void expect_identical(const Touch& a, const Touch& b) {
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    ASSERT_TRUE(same_bits(a.contacts[i], b.contacts[i]))
        << "contact " << i << ": point " << a.contacts[i].point << " depth " << a.contacts[i].depth_m << ", point "
        << b.contacts[i].point << " depth " << b.contacts[i].depth_m;
  }
  ASSERT_EQ(a.finger_count, b.finger_count);
  EXPECT_EQ(a.cluster_count, b.cluster_count);
  for (std::size_t f = 0; f < a.finger_count; ++f) {
    const Finger &p = a.fingers[f], &q = b.fingers[f];
    EXPECT_EQ(p.solid, q.solid);
    EXPECT_EQ(p.contacts, q.contacts) << "finger " << f;
    EXPECT_EQ(p.point_like, q.point_like) << "finger " << f;
    EXPECT_TRUE(same_bits(p.section, q.section)) << "finger " << f;
    EXPECT_EQ(p.placed, q.placed) << "finger " << f;
    EXPECT_EQ(p.holds, q.holds) << "finger " << f;
    ASSERT_EQ(p.foci.size(), q.foci.size()) << "finger " << f;
    for (std::size_t n = 0; n < p.foci.size(); ++n) {
      EXPECT_EQ(p.foci[n].points, q.foci[n].points) << "finger " << f << " focus " << n;
      EXPECT_EQ(p.foci[n].held, q.foci[n].held) << "finger " << f << " focus " << n;
      if (p.foci[n].points || p.placed) {
        EXPECT_TRUE(same_bits(p.foci[n].position, q.foci[n].position)) << "finger " << f << " focus " << n;
      }
    }
  }
}

std::vector<std::vector<std::uint32_t>> largest(std::vector<std::vector<std::uint32_t>> clusters) {
  std::stable_sort(clusters.begin(), clusters.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  if (clusters.size() > max_fingers) clusters.resize(max_fingers);
  std::sort(clusters.begin(), clusters.end());
  return clusters;
}

}  // namespace palpa::touch::test
