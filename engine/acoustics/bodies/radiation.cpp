#include "acoustics/bodies/radiation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "geometry/mesh/topology.hpp"

namespace palpa::acoustics {
namespace {

Vec3 area_vector(const geometry::Mesh& mesh, std::size_t face) {
  return 0.5 * geometry::area_vector(mesh, static_cast<std::uint32_t>(face));
}

}  // namespace

Vec3 face_centroid(const geometry::Mesh& mesh, std::size_t face) {
  const glm::uvec3& t = mesh.triangles[face];
  return (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
}

double face_area(const geometry::Mesh& mesh, std::size_t face) {
  return glm::length(area_vector(mesh, face));
}

Radiation radiation_of(const FaceSound& sound, const Air& air) {
  const double k = air.wave_number(), scale = 1 / (4 * air.stiffness_pa());
  double slope2 = 0;
  for (const std::complex<double>& part : sound.gradient)
    slope2 += std::norm(part);
  const double square = std::norm(sound.pressure);
  return {scale * (square - slope2 / (k * k)), scale * square};
}

Load about(const Vec3& point, const Load& load) {
  return {load.force, load.torque - glm::cross(point, load.force)};
}

void add_pressure(const RigidBody& body, std::span<const std::complex<float>> unknowns, const Air& air, double weight,
                  SkinPressure& pressure) {
  const SkinSound sound = body.on_skin(unknowns);
  pressure.langevin.resize(sound.faces.size());
  pressure.squared.resize(sound.faces.size());
  for (std::size_t face = 0; face < sound.faces.size(); ++face) {
    const Radiation one = radiation_of(sound.faces[face], air);
    pressure.loudest_pa = std::max(pressure.loudest_pa, std::abs(sound.faces[face].pressure));
    pressure.squared[face] += weight * one.squared;
    pressure.langevin[face] += weight * one.langevin;
  }
  const auto push = [&](std::size_t point, double pascals, Load& load) {
    const Vec3 force = -pascals * body.areas()[point] * body.normals()[point];
    load.force += force;
    load.torque += glm::cross(body.points()[point], force);
  };
  for (std::size_t point = 0; point < sound.samples.size(); ++point) {
    const Radiation one = radiation_of(sound.samples[point], air);
    push(point, weight * one.langevin, pressure.langevin_load);
    push(point, weight * one.squared, pressure.squared_load);
    pressure.langevin_push_n += std::abs(weight * one.langevin) * body.areas()[point];
  }
}

std::vector<double> at_vertices(const geometry::Mesh& mesh, std::span<const double> faces) {
  std::vector<double> sums(mesh.positions.size()), areas(mesh.positions.size());
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const double area = face_area(mesh, face);
    for (int corner = 0; corner < 3; ++corner) {
      sums[mesh.triangles[face][corner]] += area * faces[face];
      areas[mesh.triangles[face][corner]] += area;
    }
  }
  for (std::size_t v = 0; v < sums.size(); ++v)
    sums[v] = areas[v] > 0 ? sums[v] / areas[v] : 0;
  return sums;
}

double elongation_of(std::span<const Vec3> points, std::span<const double> areas) {
  if (points.size() < 3) return 1;
  Vec3 sum(0);
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += areas[i] * points[i];
    area += areas[i];
  }
  const Vec3 mean = sum / area;
  glm::dmat3 covariance(0);
  for (std::size_t i = 0; i < points.size(); ++i)
    covariance += areas[i] * glm::outerProduct(points[i] - mean, points[i] - mean);
  // l1 >= l2 >= l3 in closed form (Smith 1961).
  const double trace = covariance[0][0] + covariance[1][1] + covariance[2][2];
  const glm::dmat3 rest = covariance - trace / 3 * glm::dmat3(1);
  double squares = 0;
  for (int i = 0; i < 3; ++i)
    squares += glm::dot(rest[i], rest[i]);
  const double spread = std::sqrt(squares / 6);
  if (!(spread > 0)) return 1;
  const double half = glm::determinant(rest / spread) / 2;
  const double angle = std::acos(std::fmin(1, std::fmax(-1, half))) / 3;
  const double l1 = trace / 3 + 2 * spread * std::cos(angle);
  const double l3 = trace / 3 + 2 * spread * std::cos(angle + 2 * std::numbers::pi / 3);
  const double l2 = trace - l1 - l3;
  return l2 > 0 ? std::sqrt(l1 / l2) : 1;
}

Spot spot_of(const geometry::Mesh& mesh, std::span<const double> pressure) {
  Spot spot;
  for (std::size_t face = 0; face < pressure.size(); ++face) {
    if (face > 0 && !(pressure[face] > spot.peak_pa)) continue;
    spot.peak_pa = pressure[face];
    spot.peak_at = face_centroid(mesh, face);
  }
  std::vector<Vec3> places;
  std::vector<double> areas;
  for (std::size_t face = 0; face < pressure.size(); ++face) {
    if (!(pressure[face] > spot.peak_pa / 2)) continue;
    places.push_back(face_centroid(mesh, face));
    areas.push_back(face_area(mesh, face));
    spot.half_area_m2 += areas.back();
  }
  spot.half_radius_m = std::sqrt(spot.half_area_m2 / std::numbers::pi);
  spot.elongation = elongation_of(places, areas);
  return spot;
}

}  // namespace palpa::acoustics
