#include "geometry/mesh/mesh_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <utility>

#include "geometry/mesh/topology.hpp"
#include "geometry/symmetric.hpp"

namespace palpa::geometry {
namespace {

constexpr double crease_cosine = 0.985;  // ten degrees
constexpr double least_slant = 0.2;      // of a ray on a face: below it, a point's error is unknown
constexpr double still = 1e-8;           // metres: smaller steps count as no movement

/// The edges at which the mesh bends.
Mesh creases_of(const Mesh& mesh, const std::vector<Vec3>& normals) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;
  Mesh creases;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    for (const auto& [a, b] :
         {std::pair(corner.x, corner.y), std::pair(corner.y, corner.z), std::pair(corner.z, corner.x)}) {
      const auto [found, fresh] = first.try_emplace({std::min(a, b), std::max(a, b)}, t);
      if (fresh || glm::dot(normals[found->second], normals[t]) > crease_cosine) continue;
      const auto at = static_cast<std::uint32_t>(creases.positions.size());
      creases.positions.push_back(mesh.positions[a]);
      creases.positions.push_back(mesh.positions[b]);
      creases.triangles.emplace_back(at, at + 1, at + 1);
    }
  }
  return creases;
}

/// A shift, a rotation and, with seven unknowns, a change of scale.
template <std::size_t n>
Transform small_motion(const std::array<double, n>& step, const Vec3& centre, double lever_m) {
  const Vec3 shift(step[0], step[1], step[2]);
  const Vec3 turn = Vec3(step[3], step[4], step[5]) / lever_m;
  const double angle = glm::length(turn);
  Transform motion = glm::translate(Transform(1.0), centre + shift);
  if (angle > 0) motion = glm::rotate(motion, angle, turn / angle);
  if constexpr (n == 7) motion = glm::scale(motion, Vec3(1 + step[6] / lever_m));
  return glm::translate(motion, -centre);
}

/// Largest standard deviation in the space of three of the six coordinates.
double largest(const EigenPairs<6>& eigen, std::size_t first) {
  Matrix<3> covariance{};
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        covariance[i][j] += eigen.vectors[k][first + i] * eigen.vectors[k][first + j] / eigen.values[k];
    }
  }
  const EigenPairs<3> axes = eigen_of(covariance);
  return std::sqrt(std::max(0.0, *std::max_element(axes.values.begin(), axes.values.end())));
}

}  // namespace

/// A point and the place on the mesh that it belongs to.
struct MeshFit::Hit {
  Vec3 at;      ///< of the point, in the mesh's frame
  Vec3 normal;  ///< of the face
  double residual, error;
  double weight = 0;  ///< 0..1
};

namespace {

/// The typical ratio of the points' residuals to their own errors.
double scatter(const auto& hits, std::vector<double>& work) {
  work.clear();
  for (const auto& hit : hits)
    work.push_back(std::abs(hit.residual) / hit.error);
  const auto middle = work.begin() + static_cast<std::ptrdiff_t>(work.size() / 2);
  std::nth_element(work.begin(), middle, work.end());
  return std::max(1.4826 * *middle, 1e-12);
}

}  // namespace

MeshFit::MeshFit(const Mesh& mesh)
    : mesh_(mesh),
      normals_(unit_normals(mesh_)),
      nearest_(mesh_),
      creases_(creases_of(mesh_, normals_)),
      nearest_crease_(creases_) {}

void MeshFit::find_hits(std::span<const MeasuredPoint> points, const Transform& T_mesh_points,
                        const FitOptions& options, std::vector<Hit>& hits) const {
  hits.clear();
  for (const MeasuredPoint& point : points) {
    const Vec3 at = transform_point(T_mesh_points, point.position);
    const auto found = nearest_.find(at, options.gate_m);
    if (!found) continue;
    const Vec3& normal = normals_[found->triangle];
    const double along = glm::dot(normal, transform_direction(T_mesh_points, point.error));
    if (along >= 0) continue;  // it faces away
    if (nearest_crease_.distance(found->point, options.crease_m) < options.crease_m) continue;
    const double error = std::max(-along, least_slant * glm::length(point.error));
    hits.push_back({at, normal, glm::dot(normal, at - found->point), error});
  }
}

/// The summed equations of the points: for shifts, for rotations about `centre` times the lever and, with seven
/// unknowns, for the scale times the lever.
template <std::size_t n>
struct MeshFit::Sums {
  Matrix<n> weighted{};  ///< each divided by its error squared
  Matrix<n> bare{};
  std::array<double, n> right{};
  double weights = 0;
};

template <std::size_t n>
MeshFit::Sums<n> MeshFit::sum_up(std::span<const Hit> hits, const Vec3& centre, double lever_m) {
  Sums<n> sums;
  for (const Hit& hit : hits) {
    if (hit.weight <= 0) continue;
    const Vec3 turn = glm::cross(hit.at - centre, hit.normal) / lever_m;
    std::array<double, n> row{hit.normal.x, hit.normal.y, hit.normal.z, turn.x, turn.y, turn.z};
    if constexpr (n == 7) row[6] = glm::dot(hit.at - centre, hit.normal) / lever_m;
    const double weight = hit.weight / (hit.error * hit.error);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        sums.weighted[i][j] += weight * row[i] * row[j];
        sums.bare[i][j] += hit.weight * row[i] * row[j];
      }
      sums.right[i] -= weight * row[i] * hit.residual;
    }
    sums.weights += hit.weight;
  }
  return sums;
}

template <std::size_t n>
struct MeshFit::Solution {
  Transform T_mesh_points{1.0};  ///< initially the guess
  std::vector<Hit> hits{};
  std::vector<double> work{};
  Sums<n> sums{};
  double typical = 0;
};

/// False if too few points are near.
template <std::size_t n>
bool MeshFit::solve(std::span<const MeasuredPoint> points, const FitOptions& options, Solution<n>& s) const {
  for (int step = 0;; ++step) {
    find_hits(points, s.T_mesh_points, options, s.hits);
    if (s.hits.size() < n) return false;
    s.typical = scatter(s.hits, s.work);
    Vec3 centre(0);
    for (Hit& hit : s.hits) {
      const double far = hit.residual / (options.tukey * s.typical * hit.error);
      hit.weight = far * far < 1 ? (1 - far * far) * (1 - far * far) : 0;
      centre += hit.at / static_cast<double>(s.hits.size());
    }
    s.sums = sum_up<n>(s.hits, centre, options.lever_m);
    if (step == options.steps) return true;
    const EigenPairs<n> eigen = eigen_of(s.sums.weighted);
    const double most = *std::max_element(eigen.values.begin(), eigen.values.end());
    std::array<double, n> move{};
    for (std::size_t k = 0; k < n; ++k) {
      if (eigen.values[k] < 1e-6 * most) continue;  // unconstrained direction: do not move
      double along = 0;
      for (std::size_t i = 0; i < n; ++i)
        along += eigen.vectors[k][i] * s.sums.right[i];
      for (std::size_t i = 0; i < n; ++i)
        move[i] += eigen.vectors[k][i] * along / eigen.values[k];
    }
    s.T_mesh_points = small_motion(move, centre, options.lever_m) * s.T_mesh_points;
    double length = 0;
    for (const double m : move)
      length += m * m;
    if (std::sqrt(length) < still) step = options.steps - 1;
  }
}

ScaleFitted MeshFit::fit_scale(std::span<const MeasuredPoint> points, const Transform& T_guess,
                               const FitOptions& options) const {
  ScaleFitted out{.T_mesh_points = T_guess};
  Solution<7> solution{.T_mesh_points = T_guess};
  if (!solve(points, options, solution)) return out;
  out.T_mesh_points = solution.T_mesh_points;
  out.scale = 1 / std::cbrt(glm::determinant(glm::dmat3(out.T_mesh_points)));
  const EigenPairs<7> precise = eigen_of(solution.sums.weighted);
  const double most = *std::max_element(precise.values.begin(), precise.values.end());
  double variance = 0;
  for (std::size_t k = 0; k < 7; ++k) {
    const double part = precise.vectors[k][6] * precise.vectors[k][6];
    if (precise.values[k] > 1e-6 * most) {
      variance += part / precise.values[k];
    } else if (part > 1e-6) {
      return out;  // unconstrained
    }
  }
  out.deviation = solution.typical * std::sqrt(options.alike * variance) / options.lever_m;
  return out;
}

MeshFitted MeshFit::fit(std::span<const MeasuredPoint> points, const Transform& T_guess,
                        const FitOptions& options) const {
  MeshFitted out;
  out.T_mesh_points = T_guess;
  Solution<6> solution{.T_mesh_points = T_guess};
  if (!solve(points, options, solution)) return out;
  out.T_mesh_points = solution.T_mesh_points;
  auto& [T_mesh_points, hits, work, sums, typical] = solution;

  work.clear();
  double squares = 0;
  for (const Hit& hit : hits) {
    if (hit.weight <= 0) continue;
    work.push_back(std::abs(hit.residual));
    squares += hit.residual * hit.residual;
  }
  if (work.empty()) return out;
  out.points = static_cast<std::uint32_t>(work.size());
  out.rms_m = std::sqrt(squares / static_cast<double>(work.size()));
  const auto p95 = work.begin() + static_cast<std::ptrdiff_t>(work.size() * 95 / 100);
  std::nth_element(work.begin(), p95, work.end());
  out.p95_m = *p95;
  Matrix<6> bare = sums.bare;
  for (auto& row : bare) {
    for (double& value : row)
      value /= sums.weights;
  }
  const EigenPairs<6> held = eigen_of(bare);
  out.hold = std::sqrt(std::max(0.0, *std::min_element(held.values.begin(), held.values.end())));
  const EigenPairs<6> precise = eigen_of(sums.weighted);
  if (*std::min_element(precise.values.begin(), precise.values.end()) > 0) {
    const double each = typical * std::sqrt(options.alike);
    out.deviation_m = each * largest(precise, 0);
    out.deviation_rad = each * largest(precise, 3) / options.lever_m;
  }
  return out;
}

}  // namespace palpa::geometry
