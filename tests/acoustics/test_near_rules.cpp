// Sampling of neighbouring faces, also of needles. A matrix that nobody wants any more is abandoned.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "acoustics/boundary/dense_lu.hpp"
#include "acoustics/boundary/near_rules.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

/// A flat patch.
Patch patch(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{a, b - a, c - a, Vec3(0), Vec3(0), Vec3(0)}};
}

/// Samples of a triangle, finer along its first side.
std::vector<TriangleSample> fine_rule() {
  constexpr int columns = 150, rows = 4;
  std::vector<TriangleSample> rule;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      for (const LineSample& x : gauss_rule(2)) {
        for (const LineSample& y : gauss_rule(2)) {
          const double v = (j + y.at) / rows, share = (i + x.at) / columns;
          rule.push_back({share * (1 - v), v, x.weight * y.weight * (1 - v) / (columns * rows)});
        }
      }
    }
  }
  return rule;
}

/// 1/R over two patches.
double potential(const Patch& a, const Patch& b) {
  static const std::vector<TriangleSample> rule = fine_rule();
  double sum = 0;
  for (const TriangleSample& s : rule) {
    const Vec3 from = a.at(s.u, s.v);
    for (const TriangleSample& q : rule)
      sum += s.weight * q.weight / glm::distance(from, b.at(q.u, q.v));
  }
  return sum;
}

TEST(NearRules, CutNeedlesAcross) {
  const NearRules rules;
  // Side by side and end to end, fifty times as long as high.
  const Patch needle = patch({0, 0, 0}, {5e-3, 0, 0}, {2e-3, 1e-4, 0});
  for (const Vec3& way : {Vec3(1e-3, 3e-4, 0), Vec3(0, 0, 2e-4), Vec3(5.2e-3, 0, 0)}) {
    const Patch other = patch(way, way + Vec3(5e-3, 0, 0), way + Vec3(3e-3, -1e-4, 1e-5));
    PairTable cut;
    bool resolved = true;
    const PairTable& table = rules.apart(needle, other, cut, resolved);
    EXPECT_TRUE(resolved);
    EXPECT_LE(table.size(), 200000u);
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const Vec3 from = needle.at(table.u[i], table.v[i]), to = other.at(table.other_u[i], table.other_v[i]);
      sum += table.weight[i] / glm::distance(from, to);
      weights += table.weight[i];
    }
    EXPECT_NEAR(weights, 0.25, 1e-5);
    EXPECT_NEAR(sum / potential(needle, other), 1, 1e-3);
  }
  // For faces that lie exactly on each other, no division helps: it ends and reports this.
  const Patch upon = patch({0, 0, 1e-7}, {5e-3, 0, 1e-7}, {2e-3, 1e-4, 1e-7});
  PairTable cut;
  bool resolved = true;
  EXPECT_LE(rules.apart(needle, upon, cut, resolved).size(), 2400000u);
  EXPECT_FALSE(resolved);
}

TEST(NearRules, EndWhereRoundingMakesNeedlesOfAllPieces) {
  const NearRules rules;
  const Patch face = patch({2e-3, 0, 0}, {0, 2e-3, 0}, {0, 0, 2e-3});
  for (const double size : {1e-15, 1e-18, 1e-22, 1e-40, 1e-200}) {
    // At that place, doubles are farther apart than the corners are, or hardly nearer.
    const Vec3 at(3e-3, 1e-19, 1e-19);
    const Patch small = patch(at + Vec3(size, 0, 0), at + Vec3(0, size, 0), at + Vec3(0, 0, size));
    for (const auto& [test, trial] : {std::pair(face, small), std::pair(small, face), std::pair(small, small)}) {
      PairTable cut;
      bool resolved = true;
      EXPECT_LE(rules.apart(test, trial, cut, resolved).size(), 2400000u) << size;
    }
  }
}

TEST(DenseLu, CanBeGivenUp) {
  const std::vector<std::complex<float>> unit{1, 0, 0, 1};
  std::atomic<bool> give_up{true};
  EXPECT_THROW(DenseLu(unit, 2, &give_up), GivenUp);
  give_up = false;
  std::vector<std::complex<float>> column{2, 3};
  DenseLu(unit, 2, &give_up).solve(Way::forth, column);
  EXPECT_EQ(column[1], std::complex<float>(3));
}

}  // namespace
}  // namespace palpa::acoustics
