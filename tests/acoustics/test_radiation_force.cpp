// Slopes on the surface, radiation pressure and force: against the sphere's series, the momentum in the air, and finer
// meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/far_force.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/bodies/sphere_grid.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/elements/polynomial.hpp"
#include "acoustics/field/waves.hpp"
#include "acoustics/rigs.hpp"
#include "base/error.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/captured.hpp"
#include "support/exhaustive.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double radius = 8e-3;
const Vec3 along = glm::normalize(Vec3(0.48, 0.6, 0.64));

/// A plane wave on a body.
struct Pushed {
  RigidBody body;
  Air air;
  std::vector<std::complex<float>> unknowns;
  SkinPressure pressure;

  Pushed(const geometry::Mesh& mesh, double wave_number)
      : body(mesh, wave_number),
        air(air_with(wave_number)),
        unknowns(body.solve(plane_wave(wave_number, along, body.points(), body.normals()))) {
    add_pressure(body, unknowns, air, 1, pressure);
  }
  /// In m2: the force divided by that of a wave that is absorbed by 1 m2.
  Vec3 area() const { return pressure.langevin_load.force * 2.0 * air.stiffness_pa(); }
  Vec3 far_area() const {
    const FarForce far = FarForce::of(body, {}).value();
    return far.forces(plane_wave(body.wave_number(), along, far.points(), far.normals()), unknowns, air)[0] * 2.0 *
           air.stiffness_pa();
  }
};

/// A sphere whose vertices are displaced along it by up to a quarter of a side.
geometry::Mesh uneven(int divisions, unsigned seed) {
  geometry::Mesh mesh = geometry::icosphere(radius, divisions);
  const double reach = mean_side(mesh) / 4;
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  for (Vec3& p : mesh.positions) {
    const double x = number(), y = number(), z = number();
    p = radius * glm::normalize(p + reach * Vec3(x, y, z));
  }
  return mesh;
}

/// P of the series at a place on the sphere, times 4 rho c^2.
double exact_pressure(const SphereSeries& exact, double wave_number, const Vec3& place) {
  const Vec3 out = glm::normalize(place);
  const Vec3 across = along - glm::dot(along, out) * out;
  const double length = glm::length(across), step = 1e-5;
  if (length < 1e-9) return std::norm(exact.at(out));
  const Vec3 way = std::sin(step) / length * across;
  const Complex slope =
      (exact.at(std::cos(step) * out + way) - exact.at(std::cos(step) * out - way)) / (2 * step * radius);
  return std::norm(exact.at(out)) - std::norm(slope) / (wave_number * wave_number);
}

/// The area-weighted relative L2 error of the Langevin pressure at the centroids.
double pressure_error(const Pushed& sphere) {
  const double k = sphere.body.wave_number();
  const SphereSeries exact = SphereSeries::plane_wave(k, radius, along);
  Deviation off;
  for (std::size_t face = 0; face < sphere.pressure.langevin.size(); ++face) {
    off.add(sphere.pressure.langevin[face] * 4 * sphere.air.stiffness_pa(),
            exact_pressure(exact, k, face_centroid(sphere.body.mesh(), face)), face_area(sphere.body.mesh(), face));
  }
  return off.relative();
}

struct Kind {
  std::string name;
  geometry::Mesh mesh;
  double pressure_error;  ///< tolerated
  double force_error = 0.01, far_error = 0.015;
};

std::vector<Kind> spheres() {
  std::vector<Kind> kinds{{"geodesic, 80", geometry::icosphere(radius, 2), 0.32, 0.012, 0.02},
                          {"geodesic, 180", geometry::icosphere(radius, 3), 0.03},
                          {"geodesic, 320", geometry::icosphere(radius, 4), 0.02},
                          {"geodesic, 500", geometry::icosphere(radius, 5), 0.02},
                          {"uneven, 500", uneven(5, 1), 0.03},
                          {"globe, 880", test::sphere(radius, 16, 30), 0.02}};
  if (test::instrumented()) return test::the_first(2, kinds);
  kinds.push_back({"geodesic, 980", geometry::icosphere(radius, 7), 0.02});
  kinds.push_back({"uneven, 980", uneven(7, 2), 0.03});
  if (test::exhaustive()) {
    kinds.push_back({"geodesic, 2000", geometry::icosphere(radius, 10), 0.02});
    kinds.push_back({"uneven, 2000", uneven(10, 3), 0.03});
    kinds.push_back({"geodesic, 4500", geometry::icosphere(radius, 15), 0.02});
  }
  return kinds;
}

/// The advised length is followed by scaling the mesh: slightly smaller, the message is gone; slightly larger, it
/// comes.
TEST(RadiationForce, TheSidesThatAMessageAdvisesAreRight) {
  geometry::Mesh long_ones = geometry::icosphere(radius, 6);
  for (Vec3& p : long_ones.positions)
    p.x *= p.x > 0 ? 3 : 1;
  const struct {
    geometry::Mesh mesh;
    bool force;
    const char *is, *should;
    double (*side)(const geometry::Mesh&);
  } cases[]{{geometry::icosphere(radius, 4), false, "coarse: its faces' sides are (\\S+) mm",
             "below (\\S+) mm, errors are a few percent or less", mean_side},
            {geometry::icosphere(radius, 4), false, "too coarse: its faces' sides are (\\S+) mm",
             "below (\\S+) mm, results are meaningful", mean_side},
            {geometry::icosphere(radius, 4), true, "coarse: its faces' sides are (\\S+) mm",
             "below (\\S+) mm, errors are a few percent or less", mean_side},
            {long_ones, false, "a twentieth of its faces' sides are longer than (\\S+) mm",
             "if they are below (\\S+) mm, errors are a few percent or less", long_side}};
  constexpr double wavelength_m = 8.6e-3;
  for (const auto& one : cases) {
    SCOPED_TRACE(one.should);
    const auto told = [&](double side_m) {
      const double scale = side_m / one.side(one.mesh);
      const geometry::Mesh mesh = test::transformed(one.mesh, [&](const Vec3& p) { return scale * p; });
      std::string refused;
      const std::string warned = test::stderr_of([&] {
        try {
          check_fineness("body.ply", mesh, wavelength_m, one.force);
        } catch (const Error& error) {
          refused = error.what();
        }
      });
      return warned + refused;
    };
    const auto number_in = [&](const std::string& text, const char* number) {
      std::smatch found;
      return std::regex_search(text, found, std::regex(number)) ? std::stod(found[1]) * 1e-3 : 0;
    };
    // From large to small, the first length with this message.
    double side = 20e-3;
    while (side > 0.5e-3 && number_in(told(side), one.should) == 0)
      side *= 0.98;
    const double should = number_in(told(side), one.should);
    ASSERT_GT(should, 0);
    EXPECT_NEAR(number_in(told(side), one.is), side, 0.006e-3);
    EXPECT_EQ(number_in(told(0.99 * should), one.should), 0);
    EXPECT_GT(number_in(told(1.01 * should), one.should), 0);
  }
}

TEST(RadiationForce, IsTheSeriesOnEverySphereThatIsFineEnough) {
  for (const Kind& kind : spheres()) {
    // As coarse as no warning says, and finer. Only the first two kinds bend so much that there is one in any case.
    const double finest = 2 * pi * radius * std::min(1 / mean_side(kind.mesh) / 6, 1 / long_side(kind.mesh) / 5.5);
    EXPECT_EQ(mean_bend(kind.mesh) > 12 * pi / 180, kind.mesh.triangles.size() <= 180) << kind.name;
    for (const double ka : {1.0, 0.6 * finest, 0.85 * finest, 0.999 * finest}) {
      if (ka < 1 || ka > 12) continue;
      // The shortest waves are those that the large spheres add.
      if (kind.mesh.triangles.size() > 800 && ka < 0.9 * finest && !test::exhaustive()) continue;
      const Pushed sphere(kind.mesh, ka / radius);
      const Vec3 right = pi * radius * radius * sphere_force_function(ka) * along;
      const double surface = glm::length(sphere.area() - right) / glm::length(right);
      const double far = glm::length(sphere.far_area() - right) / glm::length(right);
      const double faces = pressure_error(sphere);
      EXPECT_LE(surface, kind.force_error) << kind.name << ", ka " << ka;
      EXPECT_LE(far, kind.far_error) << kind.name << ", ka " << ka;
      EXPECT_LE(faces, kind.pressure_error) << kind.name << ", ka " << ka;
      EXPECT_LE(glm::length(sphere.pressure.langevin_load.torque), 0.005 * glm::length(right) * radius);
      std::printf("  %s faces, ka %.2f: force %.2f %% off, from afar %.2f %%, pressures %.2f %%\n", kind.name.c_str(),
                  ka, 100 * surface, 100 * far, 100 * faces);
    }
  }
}

TEST(RadiationForce, OnACubeIsThatOfFinerMeshes) {
  // The limit that the momentum in the air approaches with meshes of 1728, 3072 and 6912 faces.
  const Vec3 right = 1e-6 * Vec3(67.14, 104.78, 121.30);
  // 12 squares are as few as no warning says.
  for (const int squares : {12, 16, 24}) {
    if (squares > 12 && (test::instrumented() || !test::exhaustive())) continue;
    const Pushed pushed(test::squared_cube(12e-3, squares), 732);
    const double surface = glm::length(pushed.area() - right) / glm::length(right);
    const double far = glm::length(pushed.far_area() - right) / glm::length(right);
    EXPECT_LE(surface, 0.02) << squares;
    EXPECT_LE(far, 0.02) << squares;
    std::printf("  cube of %d faces: force %.2f %% off, from afar %.2f %%\n", 12 * squares * squares, 100 * surface,
                100 * far);
  }
}

TEST(RadiationForce, OnACubeThePressuresAreThoseOfAFinerMesh) {
  if (!test::exhaustive()) GTEST_SKIP() << "solves a body of 6912 faces: set PALPA_EXHAUSTIVE";
  const double side = 12e-3, wave_number = 732;
  const Pushed coarse(test::squared_cube(side, 12), wave_number), fine(test::squared_cube(side, 24), wave_number);
  // The middle one of the four faces in which a face is divided has the same centroid.
  const auto place = [](const Vec3& p) {
    return std::array{std::lround(p.x * 1e8), std::lround(p.y * 1e8), std::lround(p.z * 1e8)};
  };
  std::map<std::array<long, 3>, double> middles;
  for (std::size_t face = 0; face < fine.pressure.langevin.size(); ++face)
    middles[place(face_centroid(fine.body.mesh(), face))] = fine.pressure.langevin[face];
  double apart = 0, all = 0;
  Deviation away;
  for (std::size_t face = 0; face < coarse.pressure.langevin.size(); ++face) {
    const Vec3 at = face_centroid(coarse.body.mesh(), face);
    ASSERT_TRUE(middles.contains(place(at)));
    const double right = middles[place(at)], wrong = coarse.pressure.langevin[face] - right;
    apart += std::abs(wrong);
    all += std::abs(right);
    std::array from_planes{side / 2 - std::abs(at.x), side / 2 - std::abs(at.y), side / 2 - std::abs(at.z)};
    std::ranges::sort(from_planes);
    if (from_planes[1] < 2 * pi / wave_number / 4) continue;  // nearer to an edge than a quarter of the wavelength
    away.add(coarse.pressure.langevin[face], right);
  }
  EXPECT_LE(apart / all, 0.12);
  EXPECT_LE(away.relative(), 0.035);
  std::printf("  1728 faces beside 6912: %.1f %% apart, away from the edges %.1f %%\n", 100 * apart / all,
              100 * away.relative());
}

/// Along z, with flat ends.
geometry::Mesh cylinder(double across, double length, int rings, int segments) {
  geometry::Mesh mesh;
  const auto ring = [&](double r, double z) {
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * pi * s / segments;
      mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  };
  const int ends = std::max(1, static_cast<int>(std::lround(across * rings / length)));
  mesh.positions.emplace_back(0, 0, -length / 2);
  for (int i = 1; i < ends; ++i)
    ring(across * i / ends, -length / 2);
  for (int i = 0; i <= rings; ++i)
    ring(across, length * (static_cast<double>(i) / rings - 0.5));
  for (int i = ends - 1; i > 0; --i)
    ring(across * i / ends, length / 2);
  mesh.positions.emplace_back(0, 0, length / 2);
  const auto corner = [&](int i, int s) { return static_cast<unsigned>(1 + i * segments + s % segments); };
  const int all = rings + 2 * ends - 1;
  const auto last = static_cast<unsigned>(mesh.positions.size() - 1);
  for (int s = 0; s < segments; ++s) {
    mesh.triangles.emplace_back(0, corner(0, s + 1), corner(0, s));
    mesh.triangles.emplace_back(last, corner(all - 1, s), corner(all - 1, s + 1));
    for (int i = 0; i + 1 < all; ++i) {
      mesh.triangles.emplace_back(corner(i, s), corner(i, s + 1), corner(i + 1, s + 1));
      mesh.triangles.emplace_back(corner(i, s), corner(i + 1, s + 1), corner(i + 1, s));
    }
  }
  return mesh;
}

TEST(RadiationForce, OnOtherBodiesIsTheMomentumInTheAir) {
  struct Body {
    std::string name;
    geometry::Mesh mesh;
    double apart;                        ///< tolerated
    std::vector<double> wave_numbers{};  ///< none: up to the finest wave that no warning is for
  };
  const auto stretched = [](const Vec3& stretch, int divisions) {
    return test::transformed(geometry::icosphere(1, divisions), [&](const Vec3& p) { return p * stretch; });
  };
  const int smooth = test::exhaustive() ? 9 : 7;
  const std::vector<double> two = test::the_first<double>(1, {300, 732.7});
  // At edges, the pressure is singular: the flatter a body or the coarser its mesh, the larger is the part of its
  // edges.
  std::vector<Body> bodies{
      {"spheroid", stretched({5e-3, 5e-3, 12e-3}, smooth), 0.02, two},
      {"lens", stretched({9e-3, 9e-3, 4e-3}, smooth), 0.02, two},
      {"egg", stretched({4e-3, 6e-3, 9e-3}, smooth), 0.02, two},
      {"box", test::divided_box({8e-3, 4e-3, 6e-3}, test::instrumented() ? 2 : 3), test::instrumented() ? 0.04 : 0.03},
      {"needle", stretched({3e-3, 3e-3, 12e-3}, test::exhaustive() ? 8 : 5), 0.02},
  };
  if (!test::instrumented()) {
    bodies.push_back({"cylinder", cylinder(4e-3, 12e-3, 12, 26), 0.03});
    bodies.push_back({"rod", cylinder(2.5e-3, 20e-3, 20, 16), 0.03});
    bodies.push_back({"disc", cylinder(8e-3, 4e-3, 4, 40), 0.04});
    bodies.push_back({"torus", test::torus(8e-3, 3e-3, 24), 0.02});
    bodies.push_back(
        {"finger", body_mesh("finger.ply", geometry::load_triangles(test::source_file("assets/finger.ply"))), 0.01});
  }
  for (const auto& [name, mesh, most, given] : bodies) {
    const double finest = std::min(2 * pi / mean_side(mesh) / 6, 2 * pi / long_side(mesh) / 5.5);
    for (const double wave_number : given.empty() ? std::vector{0.45 * finest, 0.999 * finest} : given) {
      if (mesh.triangles.size() > 4000 && wave_number < 0.9 * finest) continue;  // long to solve
      const Pushed pushed(mesh, std::min(wave_number, 1500.0));
      const Vec3 far = pushed.far_area();
      const double apart = glm::length(pushed.area() - far) / glm::length(far);
      EXPECT_LE(apart, most) << name << " " << wave_number;
      std::printf("  %s of %zu faces, k %.0f: %.2f %% apart\n", name.c_str(), mesh.triangles.size(), wave_number,
                  100 * apart);
    }
  }
}

TEST(FarForce, IsDefinedWhereNoSourceIsNear) {
  const double k = 400;
  const RigidBody body(geometry::icosphere(radius, 5), k);
  const Air air = air_with(k);
  for (const double distance : {1.02, 1.1, 2.5, 5.0}) {
    const Vec3 source = distance * radius * glm::normalize(Vec3(1, -2, 2));
    const auto far = FarForce::of(body, std::span(&source, 1));
    EXPECT_EQ(far.has_value(), distance > 1.05) << distance;
    if (!far || distance < 2) continue;  // nearer, the elements do not follow the wave
    const auto unknowns = body.solve(point_source(k, source, body.points(), body.normals()));
    SkinPressure pressure;
    add_pressure(body, unknowns, air, 1, pressure);
    const Vec3 force = far->forces(point_source(k, source, far->points(), far->normals()), unknowns, air)[0];
    EXPECT_LE(glm::length(force - pressure.langevin_load.force), 0.02 * glm::length(force)) << distance;
  }
}

TEST(FarForce, IsLeftOutWhereItWouldTakeTooLong) {
  // The sphere around the body counts.
  for (const double length : {10e-3, 100e-3, 105e-3, 400e-3, 20.0}) {
    const RigidBody body(geometry::icosphere(length / 2, 2), 732);
    EXPECT_EQ(FarForce::of(body, {}).has_value(), length < 102e-3) << length;
  }
}

TEST(FarForce, SeveralWavesAreEachAlone) {
  const double k = 500;
  const RigidBody body(
      test::transformed(geometry::icosphere(radius, 4), [](const Vec3& p) { return p + Vec3(1, 2, 3); }), k);
  const FarForce far = FarForce::of(body, {}).value();
  const Air air = air_with(k);
  Waves skin, air_around;
  std::vector<Vec3> alone;
  for (const Vec3& direction : {along, -along, Vec3(0, 0, 1)}) {
    const Waves one = plane_wave(k, direction, body.points(), body.normals());
    const Waves around = plane_wave(k, direction, far.points(), far.normals());
    alone.push_back(far.forces(around, body.solve(one), air)[0]);
    EXPECT_GT(glm::dot(alone.back(), direction), 0.99 * glm::length(alone.back()));
    for (const auto& [from, into] : {std::pair(&one, &skin), std::pair(&around, &air_around)}) {
      into->pressures.insert(into->pressures.end(), from->pressures.begin(), from->pressures.end());
      into->slopes.insert(into->slopes.end(), from->slopes.begin(), from->slopes.end());
    }
  }
  const std::vector<Vec3> together = far.forces(air_around, body.solve(skin), air);
  ASSERT_EQ(together.size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i)
    EXPECT_LE(glm::length(together[i] - alone[i]), 1e-5 * glm::length(alone[i]));
}

TEST(SphereGrid, ValuesAndCoefficientsAreTheSameFunction) {
  for (const auto& [order, rings] : {std::pair(std::size_t{0}, std::size_t{1}), {3, 4}, {9, 17}, {40, 41}}) {
    const SphereGrid grid(order, rings);
    double solid_angle = 0;
    for (const double weight : grid.weights())
      solid_angle += weight;
    EXPECT_NEAR(solid_angle, 4 * pi, 1e-11);
    std::mt19937 random(4);
    std::vector<Complex> coefficients;
    while (coefficients.size() < (order + 1) * (order + 1))
      coefficients.emplace_back(static_cast<double>(random() % 2001) - 1000,
                                static_cast<double>(random() % 2001) - 1000);
    const std::vector<Complex> values = grid.values(coefficients), back = grid.coefficients(values);
    double power = 0, integral = 0;
    for (std::size_t i = 0; i < back.size(); ++i) {
      EXPECT_LE(std::abs(back[i] - coefficients[i]), 1e-8) << order << " " << i;
      power += std::norm(coefficients[i]);
    }
    for (std::size_t i = 0; i < values.size(); ++i)
      integral += grid.weights()[i] * std::norm(values[i]);
    EXPECT_NEAR(integral / power, 1, 1e-11);
  }
}

TEST(Polynomials, AreFittedAndDerived) {
  for (std::uint32_t degree = 0; degree <= most_degree; ++degree) {
    const std::size_t terms = terms_of(degree);
    std::mt19937 random(degree);
    const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    std::vector<double> right(terms);
    for (double& coefficient : right)
      coefficient = number();
    const auto value = [&](const Monomials& at) {
      double sum = 0;
      for (std::size_t i = 0; i < terms; ++i)
        sum += right[i] * at[i];
      return sum;
    };
    LeastSquares squares(terms);
    std::vector<double> sums(terms);
    for (int equation = 0; equation < 60; ++equation) {
      const Monomials row = monomials(degree, number(), number());
      const double weight = 0.5 + std::abs(number());
      squares.add(row, weight);
      for (std::size_t i = 0; i < terms; ++i)
        sums[i] += weight * value(row) * row[i];
    }
    squares.factor();
    squares.solve(sums);
    for (std::size_t i = 0; i < terms; ++i)
      EXPECT_NEAR(sums[i], right[i], 1e-6) << degree;
    const double s = 0.3, t = -0.7, step = 1e-6;
    const MonomialSlopes slopes = monomial_slopes(degree, s, t);
    EXPECT_NEAR(value(slopes.by_s),
                (value(monomials(degree, s + step, t)) - value(monomials(degree, s - step, t))) / (2 * step), 1e-8);
    EXPECT_NEAR(value(slopes.by_t),
                (value(monomials(degree, s, t + step)) - value(monomials(degree, s, t - step))) / (2 * step), 1e-8);
  }
}

}  // namespace
}  // namespace palpa::acoustics
