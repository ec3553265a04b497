// The fast operator of large bodies against the dense one, and against what must not change it.
#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/compressed/body_operator.hpp"
#include "acoustics/compressed/fast_operator.hpp"
#include "acoustics/compressed/hierarchical_matrix.hpp"
#include "acoustics/field/waves.hpp"
#include "acoustics/rigs.hpp"
#include "base/system/parallel.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/exhaustive.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"

namespace palpa::acoustics {
namespace {

using Number = std::complex<float>;
constexpr double k = 732.5;  // 40 kHz

/// Right-hand sides of different kinds: smooth waves, and a single unknown as in backward solutions.
std::vector<Number> right_hand_sides(const geometry::Mesh& mesh) {
  const std::size_t size = mesh.positions.size();
  std::vector<Number> columns(3 * size);
  for (std::size_t v = 0; v < size; ++v) {
    const Vec3& at = mesh.positions[v];
    columns[v] = std::polar(1.0F, static_cast<float>(k * at.z));
    columns[size + v] = std::polar(1.0F, static_cast<float>(k * (0.6 * at.x - 0.8 * at.y)));
  }
  columns[2 * size + size / 3] = 1;
  return columns;
}

struct Case {
  std::string name;
  geometry::Mesh mesh;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"sphere of 980 faces", geometry::icosphere(8e-3, 7)});
  if (test::instrumented()) return all;
  all.push_back({"box of 3072 faces", test::divided_box({15e-3, 6e-3, 9e-3}, 4)});
  // One end has far longer faces than the other.
  all.push_back({"drop of 2420 faces", test::transformed(geometry::icosphere(6e-3, 11), [](const Vec3& p) {
                   return Vec3(p.x, p.y, p.z * (p.z > 0 ? 5 : 1));
                 })});
  if (!test::exhaustive()) return all;
  // Both sides of this plate are half a wavelength from each other everywhere.
  all.push_back({"plate of 3072 faces", test::divided_box({14e-3, 2e-3, 12e-3}, 4)});
  all.push_back({"torus", test::torus(20e-3, 6e-3, 40)});
  all.push_back({"sphere of 8000 faces", geometry::icosphere(20e-3, 20)});
  return all;
}

TEST(FastOperator, SolvesAsTheDenseOneDoes) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    const Patches body = make_patches(mesh);
    const auto dense = make_dense_operator(body, k), fast = make_fast_operator(body, k);
    EXPECT_TRUE(fast->iterates());
    EXPECT_FALSE(dense->iterates());
    ASSERT_EQ(fast->unknowns(), mesh.positions.size());
    const std::vector<Number> right = right_hand_sides(mesh);
    for (const Way way : {Way::forth, Way::back}) {
      std::vector<Number> expected = right, found = right;
      dense->solve(way, expected);
      const SolveReport report = fast->solve(way, found);
      const std::size_t size = mesh.positions.size();
      for (std::size_t first = 0; first < right.size(); first += size) {
        EXPECT_LT(relative_error(std::span(found).subspan(first, size), std::span(expected).subspan(first, size)), 1e-3)
            << first / size << (way == Way::forth ? " forth" : " back");
      }
      EXPECT_GT(report.iterations, 1u);
      EXPECT_LT(report.iterations, 40u);
      EXPECT_GT(report.residual, 0);
      EXPECT_LE(report.residual, 5e-5);
    }
  }
}

TEST(FastOperator, DoesNotPeakAtResonances) {
  // The inside of this sphere resonates near ka 5.785 (a flat-faced sphere is smaller than its vertices' radius).
  const geometry::Mesh mesh = geometry::icosphere(8e-3, 7);
  const Patches body = make_patches(mesh);
  std::uint32_t least = 1000, most = 0;
  for (double ka = 5.70; ka < 5.85; ka += test::exhaustive() ? 0.01 : test::instrumented() ? 0.1 : 0.02) {
    std::vector<Number> columns = right_hand_sides(mesh);
    const std::uint32_t iterations = make_fast_operator(body, ka / 8e-3)->solve(Way::forth, columns).iterations;
    least = std::min(least, iterations);
    most = std::max(most, iterations);
  }
  EXPECT_LE(most, least + 2);
}

/// During its lifetime, palpa computes with one thread.
class OneThread {
 public:
  OneThread() {
    sched_getaffinity(0, sizeof(before_), &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
      if (CPU_ISSET(cpu, &before_)) CPU_SET(cpu, &one);
    }
    sched_setaffinity(0, sizeof(one), &one);
  }
  ~OneThread() { sched_setaffinity(0, sizeof(before_), &before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  cpu_set_t before_;
};

TEST(FastOperator, HasTheSameBytesForAnyNumberOfThreads) {
  const geometry::Mesh mesh = test::divided_box({15e-3, 6e-3, 9e-3}, test::instrumented() ? 2 : 3);
  const Patches body = make_patches(mesh);
  const auto solve = [&](Way way) {
    std::vector<Number> columns = right_hand_sides(mesh);
    make_fast_operator(body, k)->solve(way, columns);
    return columns;
  };
  for (const Way way : test::the_first<Way>(1, {Way::forth, Way::back})) {
    const std::vector<Number> many = solve(way);
    const OneThread one;
    ASSERT_EQ(worker_count(), 1u);
    EXPECT_EQ(solve(way), many);
  }
}

// More right-hand sides than are solved together, one of them loud, one silent and one that is no number.
TEST(FastOperator, KeepsSilenceLoudnessAndWhatIsNoNumberAmongMany) {
  const geometry::Mesh mesh = geometry::icosphere(8e-3, 5);
  const std::size_t size = mesh.positions.size();
  const auto fast = make_fast_operator(make_patches(mesh), k);
  std::vector<Number> one = right_hand_sides(mesh);
  one.resize(size);
  const auto times = [&](Number factor) {
    std::vector<Number> column;
    for (const Number& value : one)
      column.push_back(value * factor);
    return column;
  };
  constexpr std::size_t count = 37;
  std::vector<Number> factors;
  for (std::size_t i = 0; i < count; ++i)
    factors.push_back(std::polar(1.0F, static_cast<float>(i)));
  factors.insert(factors.end(), {1e30F, 0, 1});
  std::vector<Number> all;
  for (const Number& factor : factors) {
    const std::vector<Number> column = times(factor);
    all.insert(all.end(), column.begin(), column.end());
  }
  const auto column_of = [&](std::size_t i) { return std::span(all).subspan(i * size, size); };
  column_of(count + 2)[7] = {0, std::numeric_limits<float>::quiet_NaN()};
  fast->solve(Way::forth, one);
  fast->solve(Way::forth, all);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_LT(relative_error(column_of(i), times(factors[i])), 3e-4) << i;
  std::vector<Number> quieter;
  for (const Number& value : column_of(count))
    quieter.push_back(value / 1e30F);
  EXPECT_LT(relative_error(quieter, one), 3e-4);
  for (std::size_t v = 0; v < size; ++v) {
    EXPECT_EQ(column_of(count + 1)[v], Number(0));
    EXPECT_TRUE(std::isnan(column_of(count + 2)[v].real())) << v;
  }
}

TEST(FastOperator, IsGivenUp) {
  const Patches body = make_patches(geometry::icosphere(8e-3, 7));
  const std::atomic<bool> stop = true;
  EXPECT_THROW(make_fast_operator(body, k, &stop), GivenUp);
  std::vector<Number> columns(body.mesh.positions.size(), 1);
  EXPECT_THROW(make_fast_operator(body, k)->solve(Way::forth, columns, &stop), GivenUp);
}

TEST(FastOperator, IsForLargeBodiesOnly) {
  const geometry::Mesh finger = geometry::icosphere(8e-3, 14), hand = geometry::icosphere(8e-3, 18);
  ASSERT_LT(finger.positions.size(), most_dense_vertices);
  ASSERT_GT(hand.positions.size(), most_dense_vertices);
  EXPECT_EQ(operator_bytes(finger, k), dense_operator_bytes(finger));
  EXPECT_EQ(operator_bytes(hand, k), fast_operator_bytes(hand, k));
  EXPECT_LT(fast_operator_bytes(hand, k), dense_operator_bytes(hand));
  EXPECT_FALSE(RigidBody(geometry::icosphere(8e-3, 5), k).effort().iterates);
}

TEST(FastOperator, WorksForthAndBackInLargeBodies) {
  if (test::instrumented()) GTEST_SKIP() << "takes a minute with sanitizers";
  const double radius = 8e-3;
  const Vec3 along(0, 0, 1);
  const RigidBody body(geometry::icosphere(radius, 18), k);
  EXPECT_TRUE(body.effort().iterates);
  EXPECT_EQ(body.effort().worst.iterations, 0u);
  const Waves wave = plane_wave(k, along, body.points(), body.normals());
  const std::vector<FaceSound> sound = body.at_faces(body.solve(wave));
  EXPECT_GT(body.effort().worst.iterations, 1u);
  EXPECT_LE(body.effort().worst.residual, 5e-5);
  const SphereSeries exact = SphereSeries::plane_wave(k, radius, along);
  Deviation off;
  for (std::size_t face = 0; face < sound.size(); ++face)
    off.add(sound[face].pressure, exact.at(face_centroid(body.mesh(), face)));
  EXPECT_LT(off.relative(), 2e-3);
  // One backward solution per face gives the same pressures.
  const std::vector<std::uint32_t> faces{0, 1234, 6400};
  std::vector<RigidBody::Row> rows;
  for (const std::uint32_t face : faces)
    rows.push_back(body.row_on_skin(face, 1.0 / 3, 1.0 / 3));
  const std::vector<std::complex<double>> sources = body.sources_of(rows);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    std::complex<double> sum = 0;
    for (std::size_t point = 0; point < body.points().size(); ++point) {
      const std::size_t at = i * body.points().size() + point;
      sum += sources[at] * (wave.pressures[point] + body.slope_part() * wave.slopes[point]);
    }
    EXPECT_LE(std::abs(sum - sound[faces[i]].pressure), 1e-3);
  }
}

/// The exponent of a quantity between two meshes.
double growth(double before, double after, const geometry::Mesh& smaller, const geometry::Mesh& larger) {
  return std::log(after / before) /
         std::log(static_cast<double>(larger.triangles.size()) / static_cast<double>(smaller.triangles.size()));
}

double found_bytes(const geometry::Mesh& mesh) {
  const HierarchicalMatrix matrix(make_patches(mesh), k, 5e-4);
  const auto expected = static_cast<double>(HierarchicalMatrix::expected_bytes(mesh, k));
  const auto found = static_cast<double>(matrix.bytes());
  EXPECT_LT(found, 1.1 * expected);
  EXPECT_GT(found, 0.5 * expected);
  return found;
}

TEST(HierarchicalMatrix, GrowsLittleFasterThanTheMesh) {
  // The size of blocks is also most of the work: their entries are computed once and used in each iteration.
  geometry::Mesh smaller = geometry::icosphere(8e-3, 14);
  for (const int divisions : test::the_first<int>(1, {20, 28, 40, 56})) {
    const geometry::Mesh larger = geometry::icosphere(8e-3, divisions);
    const auto bytes = [](const geometry::Mesh& mesh) {
      return static_cast<double>(HierarchicalMatrix::expected_bytes(mesh, k));
    };
    EXPECT_LT(growth(bytes(smaller), bytes(larger), smaller, larger), 1.3) << larger.triangles.size();
    smaller = larger;
  }
  // Most blocks of the small one are whole. A matrix of whole blocks only would have 2.
  const geometry::Mesh small = geometry::icosphere(8e-3, 10), large = geometry::icosphere(8e-3, 14);
  if (!test::instrumented()) {
    EXPECT_LT(growth(found_bytes(small), found_bytes(large), small, large), 1.3);
  }
}

TEST(HierarchicalMatrix, NeedsAboutTheExpectedMemory) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    found_bytes(mesh);
  }
}

}  // namespace
}  // namespace palpa::acoustics
