// The sound that arrives at a body, from its values at few places: against the whole sound, for near and far sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "acoustics/bodies/few_places.hpp"
#include "acoustics/field/waves.hpp"
#include "acoustics/rigs.hpp"
#include "base/system/parallel.hpp"
#include "geometry/mesh/icosphere.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;

/// A blunt finger of a few clusters.
const RigidBody& finger() {
  static const RigidBody body = [] {
    geometry::Mesh mesh = geometry::icosphere(8e-3, 10);
    for (Vec3& p : mesh.positions)
      p = {p.x, 2.2 * p.y, 0.9 * p.z};
    return RigidBody(std::move(mesh), 732);
  }();
  return body;
}

constexpr double exact = 1e-3;

/// Computed once for all tests.
const std::vector<FewPlaces>& exact_places() {
  static const std::vector<FewPlaces> places = few_places(finger(), exact);
  return places;
}

/// How far the unknowns of a wave are off if only its values at the few places are known, in the relative L2.
double error_of(const std::vector<FewPlaces>& clusters, const auto& wave_at) {
  const RigidBody& body = finger();
  std::vector<std::complex<float>> unknowns(body.mesh().positions.size());
  for (const FewPlaces& places : clusters) {
    std::vector<Vec3> points, normals;
    for (const std::uint32_t v : places.chosen) {
      points.push_back(body.mesh().positions[v]);
      normals.push_back(body.vertex_normals()[v]);
    }
    const Waves here = wave_at(points, normals);
    for (std::size_t s = 0; s < points.size(); ++s) {
      const Complex arrives = here.pressures[s] + body.slope_part() * here.slopes[s];
      for (std::size_t v = 0; v < places.vertices.size(); ++v)
        unknowns[places.vertices[v]] += std::complex<float>(arrives) * places.shares[s * places.vertices.size() + v];
    }
  }
  body.respond(unknowns);
  return relative_error(unknowns, body.solve(wave_at(body.points(), body.normals())));
}

TEST(FewPlaces, StandForAllVertices) {
  const RigidBody& body = finger();
  const double k = body.wave_number();
  std::size_t before = 0;
  for (const double tolerance : {1e-2, exact}) {
    const std::vector<FewPlaces> clusters = tolerance == exact ? exact_places() : few_places(body, tolerance);
    std::vector<int> held(body.mesh().positions.size());
    std::size_t chosen = 0;
    for (const FewPlaces& places : clusters) {
      for (const std::uint32_t v : places.vertices)
        ++held[v];
      ASSERT_EQ(places.shares.size(), places.vertices.size() * places.chosen.size());
      chosen += places.chosen.size();
    }
    EXPECT_GE(clusters.size(), 2U);
    EXPECT_EQ(std::ranges::count(held, 1), static_cast<std::ptrdiff_t>(held.size()));
    EXPECT_LE(chosen, held.size() / 2);
    EXPECT_GT(chosen, before);
    before = chosen;
    double worst = 0;
    for (const Vec3& way : {Vec3(0, 0, 1), Vec3(0.6, 0, -0.8), Vec3(0.48, -0.6, 0.64), Vec3(0, 1, 0)}) {
      const auto wave = [&](const auto& at, const auto& along) { return plane_wave(k, way, at, along); };
      worst = std::max(worst, error_of(clusters, wave));
    }
    // Two wavelengths from the tip, and far away.
    for (const Vec3& source : {Vec3(0, -35e-3, 0), Vec3(0.03, 0.01, -0.02), Vec3(-0.5, 1, 0.3)}) {
      const auto wave = [&](const auto& at, const auto& along) { return point_source(k, source, at, along); };
      worst = std::max(worst, error_of(clusters, wave));
    }
    EXPECT_LE(worst, 2 * tolerance);
    EXPECT_GE(worst, 0.01 * tolerance);
  }
}

TEST(FewPlaces, AreTheSameOnEveryRun) {
  const std::vector<FewPlaces>& one = exact_places();
  const std::vector<FewPlaces> two = few_places(finger(), exact);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t c = 0; c < one.size(); ++c) {
    EXPECT_EQ(one[c].chosen, two[c].chosen);
    EXPECT_EQ(one[c].shares, two[c].shares);
  }
}

TEST(FewPlaces, AreGivenUpWhenTold) {
  const std::atomic<bool> give_up = true;
  EXPECT_THROW(few_places(finger(), 3e-3, &give_up), GivenUp);
}

}  // namespace
}  // namespace palpa::acoustics
