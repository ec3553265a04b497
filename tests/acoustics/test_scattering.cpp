// Scattering by rigid bodies: against the sphere's exact series, other programs' numbers, energy and reciprocity.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "acoustics/field/waves.hpp"
#include "acoustics/rigs.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/csv.hpp"
#include "support/exhaustive.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double radius = 8e-3, wave_number = 5.86 / radius;
const Vec3 along = glm::normalize(Vec3(2, -1, 3));

/// Area-weighted relative L2 error of the pressure at the faces' centroids.
template <class Exact>
double error_of(const geometry::Mesh& mesh, const std::vector<FaceSound>& sound, const Exact& exact) {
  Deviation off;
  for (std::size_t face = 0; face < sound.size(); ++face)
    off.add(sound[face].pressure, exact(face_centroid(mesh, face)), face_area(mesh, face));
  return off.relative();
}

double plane_wave_error(const RigidBody& body, double a) {
  const auto unknowns = body.solve(plane_wave(body.wave_number(), along, body.points(), body.normals()));
  const SphereSeries exact = SphereSeries::plane_wave(body.wave_number(), a, along);
  return error_of(body.mesh(), body.at_faces(unknowns), [&](const Vec3& at) { return exact.at(at); });
}

/// The sphere with 20 * divisions^2 faces. Its equations are set up once for all tests.
const RigidBody& sphere_of(int divisions) {
  static std::map<int, std::unique_ptr<RigidBody>> made;
  std::unique_ptr<RigidBody>& body = made[divisions];
  if (!body) body = std::make_unique<RigidBody>(geometry::icosphere(radius, divisions), wave_number);
  return *body;
}

/// With sanitizers, a coarser sphere.
const RigidBody& fine_sphere() {
  return sphere_of(test::instrumented() ? 9 : 14);
}

/// h_n = j_n + i y_n, which turns outwards.
Complex hankel(unsigned order, double x) {
  return {std::sph_bessel(order, x), std::sph_neumann(order, x)};
}

/// Total pressure of the plane wave e^{ik d.x} outside the rigid sphere about the origin.
Complex sphere_in_plane_wave(double k, double a, const Vec3& direction, const Vec3& place) {
  const double ka = k * a, distance = glm::length(place);
  const double cosine = std::clamp(glm::dot(direction, place) / distance, -1.0, 1.0);
  Complex sum = std::polar(1.0, k * glm::dot(direction, place));
  for (unsigned n = 0; n < 40; ++n) {
    const Complex slope = n / ka * hankel(n, ka) - hankel(n + 1, ka);
    const Complex factor = (2.0 * n + 1) * std::polar(1.0, n * pi / 2) * slope.real() / slope;
    sum -= factor * hankel(n, k * distance) * std::legendre(n, cosine);
  }
  return sum;
}

TEST(SphereSeries, IsTheKnownNumbers) {
  const double ka = 5.86186384343285, k = ka / radius;
  const struct {
    double degrees;
    Complex plane;
  } planes[]{{0, {-1.1293232749, -0.0829824203}},
             {45, {0.2355223867, -0.5621061721}},
             {90, {1.2903548230, -0.1378674999}},
             {150, {0.9318898784, 1.6130800159}},
             {180, {1.8210651182, 0.5234965910}}};
  for (const auto& [degrees, plane] : planes) {
    const double angle = degrees * pi / 180;
    const Complex p = SphereSeries::plane_wave(k, radius, {0, 0, 1}).at({std::sin(angle), 0, std::cos(angle)});
    EXPECT_LE(std::abs(p - plane), 2e-10) << degrees;
  }
  const Complex free = std::polar(10.0, k * 0.1);
  const SphereSeries near = SphereSeries::point_source(k, radius, {0, 0.1, 0});
  EXPECT_LE(std::abs(near.at({0, 1, 0}) / free - Complex(1.9775275187, 0.5704277759)), 2e-10);
  EXPECT_LE(std::abs(near.at({1, 0, 0}) / free - Complex(1.2106437982, 0.2030658933)), 2e-10);
  EXPECT_NEAR(sphere_force_function(1), 0.4735790138, 1e-9);
  EXPECT_NEAR(sphere_force_function(5.86), 0.9089863795, 1e-9);
  // Around the sphere, the field continues the field on its surface.
  const Vec3 place(0.3 * radius, 0.4 * radius, radius * std::sqrt(0.75));
  EXPECT_LE(
      std::abs(SphereSeries::plane_wave(k, radius, along).at(place) - sphere_in_plane_wave(k, radius, along, place)),
      1e-10);
}

/// The integral of u^a v^b over the triangle.
double monomial(int a, int b) {
  return std::tgamma(a + 1.0) * std::tgamma(b + 1.0) / std::tgamma(a + b + 3.0);
}

TEST(TriangleRules, AreExactForPolynomials) {
  for (const auto& [rule, degree] : {std::pair(three_point_rule(), 2), std::pair(six_point_rule(), 4)}) {
    for (int a = 0; a <= degree; ++a) {
      double sum = 0;
      for (const TriangleSample& s : rule)
        sum += s.weight * std::pow(s.u, a) * std::pow(s.v, degree - a);
      EXPECT_NEAR(sum, monomial(a, degree - a), 1e-14);
    }
  }
  for (const Touch touch : {Touch::corner, Touch::edge, Touch::same}) {
    double sum = 0, uneven = 0;
    for (const PairSample& s : touching_rule(touch, 5)) {
      sum += s.weight;
      uneven += s.weight * s.u * s.u * s.v * s.other_v * s.other_u;
      EXPECT_TRUE(s.u >= 0 && s.v >= 0 && s.u + s.v <= 1 && s.other_u >= 0 && s.other_u + s.other_v <= 1);
    }
    EXPECT_NEAR(sum, 0.25, 1e-14);
    EXPECT_NEAR(uneven, monomial(2, 1) * monomial(1, 1), 1e-14) << static_cast<int>(touch);
  }
}

TEST(TriangleRules, TakeSingularitiesAway) {
  // 1/R over the two halves of a flat square, with each other and with themselves: (2/3) (1 + ... ) in closed form.
  const double square = 4 * (std::log(1 + std::sqrt(2.0)) + (1 - std::sqrt(2.0)) / 3);
  double sum = 0;
  for (const PairSample& s : touching_rule(Touch::same, 5))
    sum += 2 * s.weight / std::hypot(s.u - s.other_u, s.v - s.other_v);
  for (const PairSample& s : touching_rule(Touch::edge, 5)) {
    // The shared edge from (1, 0) to (0, 1), third corners (0, 0) and (1, 1).
    const double x = 1 - s.u - s.v, y = s.u, other_x = 1 - s.other_u, other_y = s.other_u + s.other_v;
    sum += 2 * s.weight / std::hypot(x - other_x, y - other_y);
  }
  EXPECT_NEAR(sum, square, 2e-4);
}

TEST(Scattering, SphereInPlaneWaveAndNearSource) {
  const double k = wave_number, most = test::instrumented() ? 0.004 : 0.001;
  const RigidBody& body = fine_sphere();
  ASSERT_EQ(body.mesh().triangles.size(), test::instrumented() ? 1620u : 3920u);
  const double plane = plane_wave_error(body, radius);
  const Vec3 source(0.06, 0, 0.08);
  const auto unknowns = body.solve(point_source(k, source, body.points(), body.normals()));
  const SphereSeries series = SphereSeries::point_source(k, radius, source);
  const auto exact = [&](const Vec3& at) { return series.at(at); };
  const double near = error_of(body.mesh(), body.at_faces(unknowns), exact);
  EXPECT_LE(plane, most);
  EXPECT_LE(near, most);
  Deviation off;
  const std::vector<Complex> vertices = body.at_vertices(unknowns);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    off.add(vertices[v], exact(body.mesh().positions[v]));
  EXPECT_LE(off.relative(), most);
  std::printf("  %zu faces: plane wave %.3f %%, point source %.3f %%, at vertices %.3f %%\n",
              body.mesh().triangles.size(), 100 * plane, 100 * near, 100 * off.relative());
}

TEST(Scattering, InsideNothingResonates) {
  // At frequencies at which the sphere's inside resonates, somewhere in these windows, K or N alone gives a large
  // response to any input. A plane wave shows it less than random numbers.
  constexpr std::size_t drawn = 4;
  // A peak is about 0.02 wide.
  const double step = test::exhaustive() ? 0.005 : test::instrumented() ? 0.05 : 0.01;
  std::vector<double> resonances{5.7635, 5.9404};
  if (test::exhaustive()) resonances.insert(resonances.end(), {5.6467, 6.2832});
  for (const double resonance : test::the_first(1, resonances)) {
    std::vector<double> errors, answers;
    for (double ka = resonance * 0.99; ka < resonance * 1.01; ka += step) {
      const RigidBody body(geometry::icosphere(radius, 6), ka / radius);
      ASSERT_EQ(body.mesh().triangles.size(), 720u);
      Waves waves = plane_wave(body.wave_number(), along, body.points(), body.normals());
      std::mt19937 random(5);
      const std::size_t all = (1 + drawn) * body.points().size();
      while (waves.pressures.size() < all)
        waves.pressures.emplace_back(static_cast<double>(random() % 2001) - 1000, random() % 2001 - 1000.0);
      waves.slopes.resize(all);
      const auto unknowns = body.solve(waves);
      const std::size_t vertices = body.mesh().positions.size();
      const SphereSeries exact = SphereSeries::plane_wave(body.wave_number(), radius, along);
      errors.push_back(error_of(body.mesh(), body.at_faces(std::span(unknowns).first(vertices)),
                                [&](const Vec3& at) { return exact.at(at); }));
      double sum = 0;
      for (const std::complex<float>& number : std::span(unknowns).subspan(vertices))
        sum += std::norm(Complex(number));
      answers.push_back(std::sqrt(sum));
    }
    for (std::vector<double>* of : {&errors, &answers}) {
      std::ranges::sort(*of);
      EXPECT_LT(of->back() / (*of)[of->size() / 2], 1.3) << resonance;
    }
    EXPECT_LE(errors.back(), 0.025) << resonance;
  }
}

TEST(Scattering, ManySourcesAreTheirSum) {
  // A drive of point sources around the sphere, like an array's.
  array::Layout layout = shell(40, 0.2);
  layout.source_level_pa_m = 1;
  layout.transducer_radius_m = 0;
  const Air air = air_with(wave_number);
  const double k = air.wave_number();
  Strengths strengths;
  for (std::size_t drive = 0; drive < 2; ++drive) {
    for (std::size_t i = 0; i < layout.transducers.size(); ++i)
      strengths.push_back(std::polar(1.0, 0.7 * static_cast<double>((drive + 1) * i)));
  }
  const RigidBody& body = sphere_of(10);
  Waves waves;
  Incident(layout, air, array::Directivity::omni).at(body.points(), body.normals(), strengths, waves);
  const auto unknowns = body.solve(waves);
  const std::size_t vertices = body.mesh().positions.size(), count = layout.transducers.size();
  std::vector<SphereSeries> exact;
  for (const array::Transducer& t : layout.transducers)
    exact.push_back(SphereSeries::point_source(k, radius, t.position));
  for (std::size_t drive = 0; drive < 2; ++drive) {
    const auto sound = body.at_faces(std::span(unknowns).subspan(drive * vertices, vertices));
    const double error = error_of(body.mesh(), sound, [&](const Vec3& at) {
      Complex sum = 0;
      for (std::size_t i = 0; i < count; ++i)
        sum += strengths[drive * count + i] * exact[i].at(at);
      return sum;
    });
    EXPECT_LE(error, 0.012);
  }
  // Reciprocity: the effect of each transducer at a face of this body, from one backward solution.
  const std::vector<std::uint32_t> faces{17, 1234};
  std::vector<RigidBody::Row> rows;
  for (const std::uint32_t face : faces)
    rows.push_back(body.row_on_skin(face, 1.0 / 3, 1.0 / 3));
  const std::vector<Complex> sources = body.sources_of(rows);
  std::vector<Complex> received;
  Incident(layout, air, array::Directivity::omni)
      .received(body.points(), body.normals(), sources, body.slope_part(), received);
  for (std::size_t drive = 0; drive < 2; ++drive) {
    const auto sound = body.at_faces(std::span(unknowns).subspan(drive * vertices, vertices));
    for (std::size_t i = 0; i < faces.size(); ++i) {
      Complex sum = 0;
      for (std::size_t t = 0; t < count; ++t)
        sum += strengths[drive * count + t] * received[i * count + t];
      EXPECT_LE(std::abs(sum - sound[faces[i]].pressure), 1e-4 * std::abs(sum) + 1e-3);
    }
  }
}

TEST(Scattering, TheAirAroundIsTheSeries) {
  const double k = wave_number;
  const RigidBody& body = fine_sphere();
  const auto unknowns = body.solve(plane_wave(k, along, body.points(), body.normals()));
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i)  // from a hundredth of a millimetre off the surface to far away
    points.push_back(direction(i) * (radius + 1e-5 * std::pow(1.25, i)));
  const auto scattered = body.scattered(unknowns, points);
  const Waves incident = plane_wave(k, along, points, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Complex exact = sphere_in_plane_wave(k, radius, along, points[i]);
    EXPECT_LE(std::abs(incident.pressures[i] + scattered[i] - exact), 0.02) << i;
  }
}

TEST(BodyMesh, InsideHoldsOnlyPointsInTheBody) {
  const Inside inside(geometry::icosphere(radius, 4));
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(inside.holds(direction(i) * radius * 0.9));
    for (const double times : {1.01, 1.5, 3.0, 100.0, 1e6})
      EXPECT_FALSE(inside.holds(direction(i) * radius * times)) << i << " " << times;
  }
}

/// A box of faces a few millimetres wide: edges, corners and flat sides.
const RigidBody& fine_box() {
  static const RigidBody box(test::divided(test::box({-7e-3, -5e-3, -4e-3}, {7e-3, 5e-3, 4e-3}), 3), wave_number);
  return box;
}

TEST(Scattering, NoEnergyIsLost) {
  // The energy scattered in all directions is the energy missing straight ahead (optical theorem).
  const RigidBody& body = fine_box();
  const double k = body.wave_number(), far = 10;
  const auto unknowns = body.solve(plane_wave(k, along, body.points(), body.normals()));
  std::vector<Vec3> points{far * along};
  std::vector<double> weights;
  const std::vector<LineSample> rings = gauss_rule(8);
  constexpr int around = 48, bands = 4;
  for (int band = 0; band < bands; ++band) {
    for (const LineSample& ring : rings) {
      const double z = 2 * (band + ring.at) / bands - 1, r = std::sqrt(1 - z * z);
      for (int i = 0; i < around; ++i) {
        points.push_back(far * Vec3(r * std::cos(2 * pi * i / around), r * std::sin(2 * pi * i / around), z));
        weights.push_back(2.0 / bands * ring.weight * 2 * pi / around);
      }
    }
  }
  const auto scattered = body.scattered(unknowns, points);
  double sent = 0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    sent += weights[i] * std::norm(far * scattered[i + 1]);
  const double missing = 4 * pi / k * (far * scattered[0] * std::polar(1.0, -k * far)).imag();
  EXPECT_NEAR(sent / missing, 1, 0.01);
}

TEST(Radiation, PushesASphereAsTheSeriesSays) {
  const double k = wave_number;
  const RigidBody& body = fine_sphere();
  const Air air = air_with(wave_number);
  const auto unknowns = body.solve(plane_wave(k, along, body.points(), body.normals()));
  SkinPressure pressure;
  add_pressure(body, unknowns, air, 1, pressure);
  const double unit = pi * radius * radius / (2 * air.stiffness_pa());
  const Load load = pressure.langevin_load;
  EXPECT_NEAR(glm::dot(load.force, along) / unit, 0.9089863795, 0.001);
  EXPECT_LE(glm::length(load.force - glm::dot(load.force, along) * along), 0.002 * unit);
  EXPECT_LE(glm::length(load.torque), 0.002 * unit * radius);
  // Without the air that moves along the skin, it would be larger by a third.
  EXPECT_NEAR(glm::dot(pressure.squared_load.force, along) / unit, 1.258, 0.006);
  std::printf("  Y_p %.4f of 0.9090\n", glm::dot(load.force, along) / unit);
  // Two halves, and their sum.
  SkinPressure twice;
  add_pressure(body, unknowns, air, 0.5, twice);
  add_pressure(body, unknowns, air, 0.5, twice);
  EXPECT_NEAR(twice.langevin[7], pressure.langevin[7], 1e-12 * std::abs(pressure.langevin[7]));
}

TEST(Radiation, ASpotIsMeasured) {
  const geometry::Mesh mesh = geometry::icosphere(radius, 20);
  std::vector<double> pressure;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    const Vec3 at = face_centroid(mesh, face);
    // Twice as long along x as along z, at the top.
    pressure.push_back(at.y < 0 ? 0 : 8 * std::exp2(-(at.x * at.x / 4e-6 + at.z * at.z / 1e-6)));
  }
  const Spot spot = spot_of(mesh, pressure);
  EXPECT_NEAR(spot.peak_pa, 8, 0.2);
  EXPECT_LE(glm::distance(spot.peak_at, Vec3(0, radius, 0)), 0.5e-3);
  EXPECT_NEAR(spot.half_area_m2, pi * 2e-6, 0.5e-6);
  EXPECT_NEAR(spot.half_radius_m, std::sqrt(2e-6), 0.06e-3);
  EXPECT_NEAR(spot.elongation, 2, 0.15);
}

geometry::Mesh read_off(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string word;
  std::size_t vertices = 0, faces = 0, edges = 0;
  stream >> word >> vertices >> faces >> edges;
  geometry::Mesh mesh;
  mesh.positions.resize(vertices);
  for (Vec3& p : mesh.positions)
    stream >> p.x >> p.y >> p.z;
  mesh.triangles.resize(faces);
  for (glm::uvec3& t : mesh.triangles)
    stream >> edges >> t.x >> t.y >> t.z;
  return mesh;
}

TEST(Scattering, AnotherProgramsSphere) {
  PALPA_SHARED_OR_SKIP(folder, "bem-sphere");
  // Its sphere is 0.175 m wide, the tone 4 kHz, and the wave comes from above.
  const double k = 2 * pi * 4000 / 343;
  const RigidBody body(read_off(folder / "sphere_1208v_2412f.off"), k);
  const auto unknowns = body.solve(plane_wave(k, {0, -1, 0}, body.points(), body.normals()));
  std::vector<Vec3> points;
  std::vector<Complex> exact, theirs;
  std::size_t rows = 0;
  for (const auto& row : test::read_csv(folder / "rigid_plane.csv")) {
    if (rows++ % 4 != 0) continue;
    points.emplace_back(row[0], row[1], row[2]);
    exact.emplace_back(row[3], row[4]);
    theirs.emplace_back(row[5], row[6]);
  }
  ASSERT_EQ(points.size(), 1890u);
  const auto scattered = body.scattered(unknowns, points);
  const Waves incident = plane_wave(k, {0, -1, 0}, points, {});
  Deviation off;
  for (std::size_t i = 0; i < points.size(); ++i)
    off.add(incident.pressures[i] + scattered[i], exact[i]);
  std::printf("  around a sphere of 2412 faces: %.3f %%, NumCalc %.3f %%\n", 100 * off.relative(),
              100 * relative_error(theirs, exact));
  EXPECT_LE(off.relative(), 0.005);
}

}  // namespace
}  // namespace palpa::acoustics
