// Scattering by rigid bodies: first the accuracy, by the sphere's series and by momentum in the air, then the time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/far_force.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/moving_body.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/boundary/surface_sound.hpp"
#include "acoustics/compressed/body_operator.hpp"
#include "acoustics/compressed/fast_operator.hpp"
#include "acoustics/elements/patches.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/waves.hpp"
#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "base/system/now.hpp"
#include "bench/bench.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/files/assets.hpp"

namespace palpa::bench {
namespace {

using acoustics::RigidBody;
using acoustics::SphereSeries;

constexpr double radius = 8e-3, default_ka = 5.86;
const Vec3 along(0, 0, 1), source(0, 0, 0.1);
constexpr std::uint32_t most_runs = 5;
/// A whole hand with faces of a sixth of a wavelength.
constexpr std::size_t large = 50'000;
/// Larger bodies are not compared with the dense operator: its memory and time grow too fast.
constexpr std::size_t most_compared = 20'000;

/// Area-weighted relative L2 error of the total pressure at the faces' centroids.
double error_of(const RigidBody& body, const acoustics::Waves& wave, const SphereSeries& exact) {
  const auto sound = body.at_faces(body.solve(wave));
  double wrong = 0, all = 0;
  for (std::size_t face = 0; face < sound.size(); ++face) {
    const std::complex<double> right = exact.at(acoustics::face_centroid(body.mesh(), face));
    const double area = acoustics::face_area(body.mesh(), face);
    wrong += area * std::norm(sound[face].pressure - right);
    all += area * std::norm(right);
  }
  return std::sqrt(wrong / all);
}

double plane_wave_error(const RigidBody& body) {
  const double k = body.wave_number();
  return error_of(body, acoustics::plane_wave(k, along, body.points(), body.normals()),
                  SphereSeries::plane_wave(k, radius, along));
}

/// Long cases run only once.
std::uint32_t runs_of(const Context& context, std::size_t faces) {
  return faces > 10'000 ? 1 : std::clamp(context.runs, 1u, most_runs);
}

/// The Y_p that results from the radiation pressure of a plane wave.
double force_function(const RigidBody& body) {
  acoustics::Air air = acoustics::without_absorption(acoustics::air_of({}));
  air.medium.frequency = body.wave_number() * air.medium.sound_speed / (2 * std::numbers::pi);
  acoustics::SkinPressure pressure;
  const auto wave = acoustics::plane_wave(body.wave_number(), along, body.points(), body.normals());
  acoustics::add_pressure(body, body.solve(wave), air, 1, pressure);
  const double unit = std::numbers::pi * radius * radius / (2 * air.stiffness_pa());
  return pressure.langevin_load.force.z / unit;
}

/// The ratio of the largest to the median error, for wave numbers near one at which a sphere's inside resonates.
double worst_by_median(double resonance) {
  std::vector<double> errors;
  for (double ka = resonance * 0.99; ka < resonance * 1.01; ka += 0.005)
    errors.push_back(plane_wave_error(RigidBody(geometry::icosphere(radius, 7), ka / radius)));
  std::ranges::sort(errors);
  return errors.back() / errors[errors.size() / 2];
}

void measure_spheres(const Context& context, std::vector<Row>& rows) {
  struct Timed {
    int faces;
    double ms;
  };
  std::optional<Timed> smaller;  // the compressed operator before
  for (const int divisions : {5, 7, 10, 14, 20, 28, 40}) {
    const int faces = 20 * divisions * divisions;
    std::vector<double> samples;
    std::optional<RigidBody> body;
    for (std::uint32_t run = 0; run < runs_of(context, static_cast<std::size_t>(faces)); ++run) {
      body.reset();
      const double begin = now_ms();
      body.emplace(geometry::icosphere(radius, divisions), default_ka / radius);
      samples.push_back(now_ms() - begin);
    }
    const double k = body->wave_number(), plane = plane_wave_error(*body);
    const double near = error_of(*body, acoustics::point_source(k, source, body->points(), body->normals()),
                                 SphereSeries::point_source(k, radius, source));
    const double force = force_function(*body);
    if (faces > 3000 && std::max(plane, near) > 0.005) wrong("a sphere's pressure is more than 0.5 % off its series");
    if (faces > 3000 && std::abs(force / acoustics::sphere_force_function(default_ka) - 1) > 0.01)
      wrong("the force on a sphere is more than 1 % off its series");
    rows.push_back(make_row("acoustics", fmt::format("sphere, {} faces", faces), "operator", std::move(samples)));
    rows.back().note = fmt::format("ka 5.86: plane wave {:.3f} %, point source {:.3f} %, Y_p {:.4f} of {:.4f}; {} MB",
                                   plane * 100, near * 100, force, acoustics::sphere_force_function(default_ka),
                                   acoustics::operator_bytes(body->mesh(), k) / 1'000'000);
    if (!body->effort().iterates) continue;
    const double ms = rows.back().median_ms;
    if (smaller) {
      rows.back().note +=
          fmt::format("; the time grew with the faces to the power of {:.2f}",
                      std::log(ms / smaller->ms) / std::log(static_cast<double>(faces) / smaller->faces));
    }
    smaller = Timed{faces, ms};
  }
  for (const double resonance : {5.6467, 5.7635, 5.9404, 6.2832}) {
    const double begin = now_ms(), worst = worst_by_median(resonance);
    if (worst > 1.3) wrong(fmt::format("errors peak near ka {}", resonance));
    rows.push_back(make_row("acoustics", fmt::format("sphere, ka {} +- 1 %", resonance), "scan", {now_ms() - begin}));
    rows.back().note = fmt::format("980 faces, steps of 0.005: largest error {:.3f} times the median", worst);
  }
}

/// How far a force is off, in parts of the right one.
double off(const Vec3& force, const Vec3& right) {
  return glm::distance(force, right) / glm::length(right);
}

/// A plane wave on a body: its force by radiation pressure and by momentum in the air, with the time that the second
/// takes beside the solution. `right` times 1 Pa^2 / (2 rho c^2) is the force to compare with; without one, the force
/// by momentum in the air.
void measure_force(const Context& context, const std::string& name, const geometry::Mesh& mesh, double wave_number,
                   const std::optional<Vec3>& right, double most, std::vector<Row>& rows) {
  acoustics::Air air = acoustics::without_absorption(acoustics::air_of({}));
  air.medium.frequency = wave_number * air.medium.sound_speed / (2 * std::numbers::pi);
  const Vec3 way = glm::normalize(Vec3(0.48, 0.6, 0.64));
  const double begin = now_ms();
  const RigidBody body(mesh, wave_number);
  const auto unknowns = body.solve(acoustics::plane_wave(wave_number, way, body.points(), body.normals()));
  acoustics::SkinPressure pressure;
  acoustics::add_pressure(body, unknowns, air, 1, pressure);
  const double solved = now_ms() - begin;
  std::vector<double> samples;
  Vec3 far_force(0);
  for (std::uint32_t run = 0; run < std::clamp(context.runs, 1u, most_runs); ++run) {
    const double start = now_ms();
    const acoustics::FarForce far = acoustics::FarForce::of(body, {}).value();
    far_force = far.forces(acoustics::plane_wave(wave_number, way, far.points(), far.normals()), unknowns, air)[0];
    samples.push_back(now_ms() - start);
  }
  const Vec3 expected = right ? *right / (2 * air.stiffness_pa()) : far_force;
  const Vec3 force = pressure.langevin_load.force;
  if (off(force, expected) > most) wrong(fmt::format("the force on {} is more than {} % off", name, 100 * most));
  if (off(force, far_force) > 0.03) wrong(fmt::format("two ways to the force on {} are more than 3 % apart", name));
  rows.push_back(make_row("acoustics", name, "far force", std::move(samples)));
  rows.back().note = fmt::format("force {:.2f} % off, by momentum in the air {:.2f} %; the rest took {:.0f} ms",
                                 100 * off(force, expected), 100 * off(far_force, expected), solved);
}

/// A box of equal sides, each divided into squares of two triangles.
geometry::Mesh cube(double side, int squares) {
  geometry::Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, second = (axis + 1) % 3, third = (axis + 2) % 3;
    const bool high = face % 2 == 1;
    const auto at = [&](int i, int j) {
      Vec3 p;
      p[axis] = high ? side / 2 : -side / 2;
      p[second] = side * i / squares - side / 2;
      p[third] = side * j / squares - side / 2;
      return p;
    };
    for (int i = 0; i < squares; ++i) {
      for (int j = 0; j < squares; ++j) {
        const auto first = static_cast<unsigned>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        const glm::uvec3 one = high ? glm::uvec3(0, 1, 2) : glm::uvec3(0, 2, 1);
        const glm::uvec3 two = high ? glm::uvec3(0, 2, 3) : glm::uvec3(0, 3, 2);
        mesh.triangles.push_back(one + first);
        mesh.triangles.push_back(two + first);
      }
    }
  }
  return geometry::weld(mesh, side * 1e-6);
}

void measure_forces(const Context& context, std::vector<Row>& rows) {
  for (const auto& [divisions, ka] :
       {std::pair(3, 1.5), {5, 3.0}, {7, 3.0}, {7, 5.86}, {10, 8.0}, {14, 10.0}, {14, 12.0}}) {
    const Vec3 way = glm::normalize(Vec3(0.48, 0.6, 0.64));
    measure_force(context, fmt::format("sphere, {} faces, ka {}", 20 * divisions * divisions, ka),
                  geometry::icosphere(radius, divisions), ka / radius,
                  std::numbers::pi * radius * radius * acoustics::sphere_force_function(ka) * way, 0.01, rows);
  }
  // The limit of the momentum in the air for finer meshes.
  const Vec3 of_cube = 1e-6 * Vec3(67.14, 104.78, 121.30);
  for (const int squares : {12, 16, 24})
    measure_force(context, fmt::format("cube, {} faces", 12 * squares * squares), cube(12e-3, squares), 732, of_cube,
                  0.02, rows);
  geometry::Mesh spheroid = geometry::icosphere(1, 10);
  for (Vec3& p : spheroid.positions)
    p *= Vec3(5e-3, 5e-3, 12e-3);
  measure_force(context, "spheroid, 2000 faces", spheroid, 732, 1e-6 * Vec3(83.61, 104.51, 29.70), 0.02, rows);
  measure_force(context, "finger.ply",
                acoustics::body_mesh("finger.ply", geometry::load_triangles(setup::find_asset("finger.ply"))), 732, {},
                0.02, rows);
}

/// Divides the longest sides of a closed mesh, and so on, until it has `faces` faces.
void refine(geometry::Mesh& mesh, std::size_t faces) {
  using Side = std::pair<std::uint32_t, std::uint32_t>;
  // Sides a little shorter than the longest are divided in the same pass.
  constexpr double similar = 0.75;
  while (mesh.triangles.size() < faces) {
    std::map<Side, std::vector<std::uint32_t>> triangles_at;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (int c = 0; c < 3; ++c)
        triangles_at[std::minmax(mesh.triangles[t][c], mesh.triangles[t][(c + 1) % 3])].push_back(t);
    }
    std::vector<std::pair<double, Side>> sides;
    sides.reserve(triangles_at.size());
    for (const auto& [side, triangles] : triangles_at)
      sides.emplace_back(glm::distance(mesh.positions[side.first], mesh.positions[side.second]), side);
    std::ranges::sort(sides, std::greater());
    const double longest = sides.front().first;
    std::vector<std::uint8_t> divided(mesh.triangles.size());
    for (const auto& [length, side] : sides) {
      if (length < similar * longest || mesh.triangles.size() >= faces) break;
      const auto& [a, b] = side;
      const std::vector<std::uint32_t>& triangles = triangles_at[side];
      if (std::ranges::any_of(triangles, [&](std::uint32_t t) { return divided[t] != 0; })) continue;
      const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
      for (const std::uint32_t t : triangles) {
        divided[t] = 1;
        glm::uvec3 other = mesh.triangles[t];
        for (int c = 0; c < 3; ++c) {
          if (mesh.triangles[t][c] == a) mesh.triangles[t][c] = middle;
          if (other[c] == b) other[c] = middle;
        }
        mesh.triangles.push_back(other);
      }
    }
  }
}

/// The largest difference of pressures at any face from those of the dense operator, in parts of the loudest, and their
/// relative L2.
std::string beside_dense(const geometry::Mesh& mesh, double wave_number) {
  const acoustics::Patches patches = acoustics::make_patches(mesh);
  const std::size_t vertices = mesh.positions.size();
  std::vector<std::complex<float>> fast(vertices);
  for (std::size_t v = 0; v < vertices; ++v)
    fast[v] = std::polar(1.0F, static_cast<float>(wave_number * mesh.positions[v].x));
  std::vector<std::complex<float>> dense = fast;
  acoustics::make_fast_operator(patches, wave_number)->solve(acoustics::Way::forth, fast);
  acoustics::make_dense_operator(patches, wave_number)->solve(acoustics::Way::forth, dense);
  const acoustics::SurfaceFit fit(patches);
  const auto found = fit.at_faces(fast), expected = fit.at_faces(dense);
  double off = 0, all = 0, worst = 0, loudest = 0;
  for (std::size_t face = 0; face < found.size(); ++face) {
    const double difference = std::abs(found[face].pressure - expected[face].pressure);
    off += difference * difference;
    all += std::norm(expected[face].pressure);
    worst = std::max(worst, difference);
    loudest = std::max(loudest, std::abs(expected[face].pressure));
  }
  const double error = std::sqrt(off / all);
  if (error > 0.003) wrong("the fast operator is more than 0.3 % off the dense one");
  return fmt::format("{:.3f} % beside the dense operator, at most {:.2f} % of the loudest", 100 * error,
                     100 * worst / loudest);
}

/// Foci on a circle of 3 mm at the tip of a body that stands 3 mm below the origin, by the paper's array: from the file
/// to the pressures on its skin. `faces`: the mesh is refined to this many.
void measure_body(const Context& context, const std::string& asset, std::size_t faces, std::vector<Row>& rows) {
  const acoustics::Air air = acoustics::air_of({});
  const array::Layout layout = array::load_layout("paper");
  acoustics::Strengths strengths;
  for (int focus = 0; focus < 10; ++focus) {
    const double angle = 0.2 * std::numbers::pi * focus;
    const array::SlotFocus one{{3e-3 * std::cos(angle), -2e-3, 3e-3 * std::sin(angle)}};
    const acoustics::Strengths own = acoustics::strengths_of(array::drive_for(layout, {&one, 1}));
    strengths.insert(strengths.end(), own.begin(), own.end());
  }
  const acoustics::Incident incident(layout, air, array::Directivity::t4010a1);
  std::vector<double> operators, sets, ones, totals;
  const auto mesh_of_asset = [&] {
    geometry::Mesh mesh = acoustics::body_mesh(asset, geometry::load_triangles(setup::find_asset(asset)));
    refine(mesh, faces);
    const double lowest = geometry::bounds(mesh).low.y;
    for (Vec3& p : mesh.positions)
      p.y -= lowest + 3e-3;
    return mesh;
  };
  const geometry::Mesh mesh = mesh_of_asset();
  const std::size_t vertices = mesh.positions.size(), transducers = layout.transducers.size();
  acoustics::RigidBody::Effort effort;
  for (std::uint32_t run = 0; run < runs_of(context, mesh.triangles.size()); ++run) {
    const double begin = now_ms();
    geometry::Mesh own = mesh_of_asset();
    const double read = now_ms();
    const RigidBody body(std::move(own), air.wave_number());
    const double ready = now_ms();
    const auto solve = [&](std::size_t foci) {
      acoustics::Waves waves;
      incident.at(body.points(), body.normals(), std::span(strengths).first(foci * transducers), waves);
      const auto unknowns = body.solve(waves);
      acoustics::SkinPressure pressure;
      for (std::size_t focus = 0; focus < foci; ++focus) {
        acoustics::add_pressure(body, std::span(unknowns).subspan(focus * vertices, vertices), air, 0.1, pressure);
      }
    };
    solve(10);
    const double end = now_ms();
    solve(1);
    ones.push_back(now_ms() - end);
    operators.push_back(ready - read);
    sets.push_back(end - ready);
    totals.push_back(end - begin);
    effort = body.effort();
  }
  const std::string name = fmt::format("{}, {} faces", asset, mesh.triangles.size());
  rows.push_back(make_row("acoustics", name, "operator", std::move(operators)));
  if (effort.iterates && mesh.triangles.size() < most_compared)
    rows.back().note = beside_dense(mesh, air.wave_number());
  rows.push_back(make_row("acoustics", name, "one focus", std::move(ones)));
  rows.push_back(make_row("acoustics", name, "ten foci", std::move(sets)));
  rows.back().note = "3984 transducers to pressures on the skin";
  if (effort.iterates) {
    rows.back().note += fmt::format("; {} iterations, residual {:.1e}", effort.worst.iterations, effort.worst.residual);
  }
  rows.push_back(make_row("acoustics", name, "total", std::move(totals)));
  rows.back().note = fmt::format("from the file to the pressures for ten foci; process at most {} MB so far",
                                 peak_resident_bytes() / 1'000'000);
}

/// The sound of the paper's transducers at ten foci on the finger's skin, as for each new place of a finger in a run.
void measure_tracked(const Context& context, std::vector<Row>& rows) {
  const acoustics::Air air = acoustics::without_absorption(acoustics::air_of({}));
  const array::Layout layout = array::load_layout("paper");
  const auto body = std::make_shared<const RigidBody>(
      acoustics::body_mesh("finger.ply", geometry::load_triangles(setup::find_asset("finger.ply"))), air.wave_number());
  const double begin = now_ms();
  const acoustics::MovingBody tracked(body, air, array::Directivity::t4010a1);
  rows.push_back(make_row("acoustics", "finger.ply, in a run", "few places", {now_ms() - begin}));
  acoustics::FingerTransfer exact(*body, layout, air, array::Directivity::t4010a1);
  std::vector<Vec3> foci;
  for (int focus = 0; focus < 10; ++focus) {
    const double angle = 0.2 * std::numbers::pi * focus;
    foci.emplace_back(3e-3 * std::cos(angle), 1e-3, 3e-3 * std::sin(angle));
  }
  std::vector<acoustics::MovingBody::Heard> heard;
  std::vector<double> samples;
  for (std::uint32_t run = 0; run < std::clamp(context.runs, 1u, 20u); ++run) {
    const double start = now_ms();
    heard = tracked.hear(foci, layout);
    samples.push_back(now_ms() - start);
  }
  for (std::size_t j = 0; j < foci.size(); ++j)
    foci[j] = heard[j].place;
  exact.aim(foci);
  double worst = 0, loudest = 0;
  array::Columns columns;
  for (std::size_t j = 0; j < foci.size(); ++j) {
    const array::FocusSource one{foci[j], 0, 1};
    exact.fill({&one, 1}, array::Weighting::uniform, columns);
    for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
      const std::complex<double> right = layout.source_level_pa_m * columns.transfer(t);
      worst = std::max(worst, std::abs(heard[j].sound[t] - right));
      loudest = std::max(loudest, std::abs(right));
    }
  }
  if (worst > 0.005 * loudest) wrong("the sound on a finger in a run is more than 0.5 % off");
  rows.push_back(make_row("acoustics", "finger.ply, in a run", "ten foci", std::move(samples)));
  rows.back().note = fmt::format("3984 transducers at a new place of the finger: at most {:.2f} % of the loudest off",
                                 100 * worst / loudest);
}

}  // namespace

void measure_scattering(const Context& context, std::vector<Row>& rows) {
  measure_body(context, "finger.ply", 0, rows);
  measure_tracked(context, rows);
  measure_spheres(context, rows);
  measure_forces(context, rows);
  measure_body(context, "hand.glb", large, rows);
  measure_body(context, "hand.glb", 0, rows);
}

}  // namespace palpa::bench
