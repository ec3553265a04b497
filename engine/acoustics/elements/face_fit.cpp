#include "acoustics/elements/face_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <span>

#include "acoustics/elements/triangle_rules.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::acoustics {
namespace {

constexpr std::uint32_t usual_rings = 2, most_rings = 4;
constexpr std::uint32_t smooth_degree = 5, edge_degree = 4;
/// A fit needs this many vertices for each of its coefficients.
constexpr double vertices_per_term = 1.2;
/// Cosines of the angle by which the surface may turn away: of a face that belongs to a fit, and of one that is touched
/// by the hat function of one of its vertices. Farther away, the plane's coordinates fold.
constexpr double least_cosine = 0.3, least_hat_cosine = -0.15;
/// The least cosine by whose square a vertex counts.
constexpr double least_weight_cosine = 0.1;

std::uint32_t next(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

/// Calls `found` with the faces that share a corner with `face` without a sharp edge in between.
template <class Found>
void faces_around(const Patches& body, std::uint32_t face, const Found& found) {
  for (std::uint32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
    // In both directions around the corner's vertex, until a sharp edge or the start.
    std::uint32_t at = corner;
    while (!body.sharp[at]) {
      at = next(body.twin[at]);
      if (at == corner) break;
      found(at / 3);
    }
    if (at == corner && !body.sharp[at]) continue;  // all around
    for (at = corner; !body.sharp[next(next(at))];) {
      at = body.twin[next(next(at))];
      if (at == corner) break;
      found(at / 3);
    }
  }
}

bool enough(std::size_t vertices, std::uint32_t degree) {
  return static_cast<double>(vertices) >= vertices_per_term * static_cast<double>(terms_of(degree));
}

std::uint32_t degree_for(std::uint32_t most, std::size_t vertices) {
  while (most > 1 && !enough(vertices, most))
    --most;
  return most;
}

std::array<double, 3> hats(const TriangleSample& q) {
  return {1 - q.u - q.v, q.u, q.v};
}

}  // namespace

FitTables::FitTables(const Patches& body) : body_(body), edged_(body.mesh.positions.size()) {
  for (std::uint32_t face = 0; face < body.patches.size(); ++face) {
    normals_.push_back(glm::normalize(geometry::area_vector(body.mesh, face)));
    for (const TriangleSample& q : six_point_rule()) {
      at_.push_back(body.patches[face].at(q.u, q.v));
      areas_.push_back(q.weight * glm::length(body.patches[face].area_vector(q.u, q.v)));
    }
  }
  for (std::uint32_t side = 0; side < body.sharp.size(); ++side) {
    if (!body.sharp[side]) continue;
    for (const std::uint32_t vertex : geometry::side_vertices(body.mesh, side))
      edged_[vertex] = 1;
  }
}

FitMaker::FitMaker(const FitTables& tables)
    : tables_(tables),
      faces_(tables.body().patches.size()),
      vertices_(tables.body().mesh.positions.size()),
      used_(tables.body().mesh.positions.size()) {}

/// Adds the faces around those in [begin, end) of the list; only those that face as `facing`, if given.
void FitMaker::add_ring(std::size_t begin, std::size_t end, const Vec3* facing) {
  for (std::size_t i = begin; i < end; ++i) {
    faces_around(tables_.body(), faces_.list()[i], [&](std::uint32_t other) {
      if (facing && glm::dot(tables_.normal(other), *facing) < least_cosine) return;
      faces_.add(other);
    });
  }
}

/// The faces of a fit: two rings, or more until there are enough vertices. Their vertices.
void FitMaker::choose_faces(std::uint32_t face, const Vec3& normal) {
  faces_.clear();
  vertices_.clear();
  faces_.add(face);
  std::size_t counted = 0, front = 0;
  for (std::uint32_t ring = 0;; ++ring) {
    for (; counted < faces_.list().size(); ++counted) {
      const glm::uvec3& t = tables_.body().mesh.triangles[faces_.list()[counted]];
      for (int c = 0; c < 3; ++c)
        vertices_.add(t[c]);
    }
    if (ring >= most_rings || (ring >= usual_rings && enough(vertices_.list().size(), smooth_degree))) return;
    const std::size_t end = faces_.list().size();
    add_ring(front, end, &normal);
    if (faces_.list().size() == end) return;
    front = end;
  }
}

Monomials FitMaker::row(const FaceFit& fit, std::uint32_t face, std::size_t sample) const {
  const Vec3 from = tables_.at(face, sample) - fit.origin;
  return monomials(fit.degree, glm::dot(from, fit.s), glm::dot(from, fit.t));
}

void FitMaker::solve(FaceFit& fit, LeastSquares& squares) {
  const std::size_t terms = terms_of(fit.degree);
  const std::size_t count = fit.vertices.size();
  squares.factor();
  squares.solve(factors_, count);
  fit.factors.resize(factors_.size());
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t i = 0; i < terms; ++i)
      fit.factors[v * terms + i] = static_cast<float>(factors_[i * count + v]);
  }
}

/// To the linear elements, over the area of the faces.
void FitMaker::fit_areas(FaceFit& fit) {
  fit.averaged = false;
  fit.vertices = vertices_.list();
  fit.degree = degree_for(edge_degree, fit.vertices.size());
  const std::size_t terms = terms_of(fit.degree);
  const double scale2 = glm::dot(fit.s, fit.s);
  factors_.assign(fit.vertices.size() * terms, 0);
  LeastSquares squares(terms);
  for (const std::uint32_t face : faces_.list()) {
    const glm::uvec3& t = tables_.body().mesh.triangles[face];
    for (std::size_t sample = 0; sample < FitTables::samples; ++sample) {
      const Vec3 from = tables_.at(face, sample) - fit.origin;
      // The rim counts next to nothing.
      const double in = std::max(0.0, 1 - glm::dot(from, from) * scale2 / (1.05 * 1.05));
      const double weight = tables_.area(face, sample) * scale2 * (in * in + 1e-4);
      const Monomials there = row(fit, face, sample);
      squares.add(there, weight);
      const std::array<double, 3> hat = hats(six_point_rule()[sample]);
      for (std::size_t c = 0; c < 3; ++c) {
        double* const into = &factors_[vertices_.place(t[static_cast<int>(c)])];
        for (std::size_t i = 0; i < terms; ++i)
          into[i * fit.vertices.size()] += weight * hat[c] * there[i];
      }
    }
  }
  solve(fit, squares);
}

/// To the hat averages of the vertices of the faces, without those on a sharp edge or around a bend. Returns false if
/// they are too few.
bool FitMaker::fit_averages(FaceFit& fit, const Vec3& normal, double side) {
  const geometry::Mesh& mesh = tables_.body().mesh;
  const std::size_t own = faces_.list().size();
  add_ring(0, own, nullptr);
  const std::vector<std::uint32_t>& reached = faces_.list();
  // Vertices that are left out, then those that are used.
  used_.clear();
  for (const std::uint32_t face : reached) {
    if (glm::dot(tables_.normal(face), normal) >= least_hat_cosine) continue;
    for (int c = 0; c < 3; ++c)
      used_.add(mesh.triangles[face][c]);
  }
  fit.vertices.clear();
  for (const std::uint32_t vertex : vertices_.list()) {
    if (!used_.has(vertex) && !tables_.edged(vertex)) fit.vertices.push_back(vertex);
  }
  if (!enough(fit.vertices.size(), 2)) return false;
  used_.clear();
  for (const std::uint32_t vertex : fit.vertices)
    used_.add(vertex);
  fit.degree = degree_for(smooth_degree, fit.vertices.size());
  fit.averaged = true;

  const std::size_t terms = terms_of(fit.degree), count = fit.vertices.size();
  rows_.assign(count, Monomials{});
  areas_.assign(count, 0);
  cosines_.assign(count, 0);
  for (const std::uint32_t face : reached) {
    const glm::uvec3& t = mesh.triangles[face];
    if (!used_.has(t.x) && !used_.has(t.y) && !used_.has(t.z)) continue;
    const double cosine = glm::dot(tables_.normal(face), normal);
    for (std::size_t sample = 0; sample < FitTables::samples; ++sample) {
      const Monomials there = row(fit, face, sample);
      const std::array<double, 3> hat = hats(six_point_rule()[sample]);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t vertex = t[static_cast<int>(c)];
        if (!used_.has(vertex)) continue;
        const std::size_t place = used_.place(vertex);
        const double weight = hat[c] * tables_.area(face, sample);
        areas_[place] += weight;
        cosines_[place] += weight * cosine;
        for (std::size_t i = 0; i < terms; ++i)
          rows_[place][i] += weight * there[i];
      }
    }
  }
  LeastSquares squares(terms);
  factors_.assign(count * terms, 0);
  for (std::size_t v = 0; v < count; ++v) {
    for (double& entry : rows_[v])
      entry /= areas_[v];
    const Vec3 from = mesh.positions[fit.vertices[v]] - fit.origin;
    const double cosine = std::max(cosines_[v] / areas_[v], least_weight_cosine);
    const double near = std::exp(-glm::dot(from, from) / (side * side));
    const double weight = areas_[v] / (side * side) * near * cosine * cosine;
    squares.add(rows_[v], weight);
    for (std::size_t i = 0; i < terms; ++i)
      factors_[i * count + v] = weight * rows_[v][i];
  }
  solve(fit, squares);
  return true;
}

FaceFit FitMaker::make(std::uint32_t face) {
  const Patches& body = tables_.body();
  const Patch& own = body.patches[face];
  const Vec3 area = own.area_vector(1.0 / 3, 1.0 / 3), normal = glm::normalize(area);
  choose_faces(face, normal);
  FaceFit fit;
  fit.origin = own.at(1.0 / 3, 1.0 / 3);
  double radius2 = 0;
  for (const std::uint32_t v : vertices_.list()) {
    const Vec3 from = body.mesh.positions[v] - fit.origin;
    radius2 = std::max(radius2, glm::dot(from, from));
  }
  const Vec3 s = glm::normalize(own.along_u(1.0 / 3, 1.0 / 3));
  fit.s = s / std::sqrt(radius2);
  fit.t = glm::cross(normal, s) / std::sqrt(radius2);
  // The side of an equilateral triangle of this area; the area vector is twice the area.
  const double side = std::sqrt(2 / std::sqrt(3.0) * glm::length(area));
  const bool edged = std::ranges::any_of(faces_.list(), [&](std::uint32_t f) {
    const std::size_t first = std::size_t{3} * f;
    return body.sharp[first] || body.sharp[first + 1] || body.sharp[first + 2];
  });
  if (edged || !fit_averages(fit, normal, side)) {
    choose_faces(face, normal);
    fit_areas(fit);
  }
  return fit;
}

}  // namespace palpa::acoustics
