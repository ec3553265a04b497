#include "acoustics/boundary/surface_sound.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "acoustics/boundary/polynomial.hpp"
#include "acoustics/boundary/triangle_rules.hpp"
#include "base/parallel.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::acoustics {
namespace {

constexpr std::uint32_t usual_rings = 2, most_rings = 4;
constexpr std::uint32_t smooth_degree = 5, edge_degree = 4;
/// A fit needs this many vertices for each of its coefficients.
constexpr double vertices_per_term = 1.2;
/// Cosines of the angle by which the surface may turn away: of a face that belongs to a fit, and of one that is touched
/// by the hat function of one of its vertices. Farther away, the plane's coordinates fold.
constexpr double least_cosine = 0.3, least_hat_cosine = -0.15, least_weight_cosine = 0.1;

std::uint32_t next(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

void make_set(std::vector<std::uint32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

bool contains(const std::vector<std::uint32_t>& set, std::uint32_t item) {
  return std::binary_search(set.begin(), set.end(), item);
}

/// Calls `found` with the faces that share a corner with `face` without a sharp edge in between.
template <class Found>
void faces_around(const Patches& body, std::uint32_t face, const Found& found) {
  for (std::uint32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
    // In both directions around the corner's vertex, until a sharp edge or the start.
    for (std::uint32_t at = corner; !body.sharp[at];) {
      at = next(body.twin[at]);
      if (at == corner) break;
      found(at / 3);
    }
    for (std::uint32_t at = corner; !body.sharp[next(next(at))];) {
      at = body.twin[next(next(at))];
      if (at == corner) break;
      found(at / 3);
    }
  }
}

Vec3 normal_of(const geometry::Mesh& mesh, std::uint32_t face) {
  return glm::normalize(geometry::area_vector(mesh, face));
}

bool is_edged(const Patches& body, const std::vector<std::uint32_t>& faces) {
  return std::ranges::any_of(faces, [&](std::uint32_t face) {
    return body.sharp[3 * face] || body.sharp[3 * face + 1] || body.sharp[3 * face + 2];
  });
}

std::vector<std::uint32_t> vertices_of(const geometry::Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t face : faces) {
    const glm::uvec3& t = mesh.triangles[face];
    vertices.insert(vertices.end(), {t.x, t.y, t.z});
  }
  make_set(vertices);
  return vertices;
}

/// The faces next to `faces` that are not among them, up to sharp edges.
std::vector<std::uint32_t> next_ring(const Patches& body, const std::vector<std::uint32_t>& faces,
                                     const std::vector<std::uint32_t>& front) {
  std::vector<std::uint32_t> ring;
  for (const std::uint32_t face : front) {
    faces_around(body, face, [&](std::uint32_t other) {
      if (!contains(faces, other)) ring.push_back(other);
    });
  }
  make_set(ring);
  return ring;
}

/// The faces of a fit: two rings, or more until there are enough vertices.
std::vector<std::uint32_t> faces_of_fit(const Patches& body, std::uint32_t face, const Vec3& normal) {
  std::vector<std::uint32_t> faces{face}, front{face};
  const double enough = vertices_per_term * static_cast<double>(terms_of(smooth_degree));
  for (std::uint32_t ring = 0; ring < most_rings; ++ring) {
    if (ring >= usual_rings && static_cast<double>(vertices_of(body.mesh, faces).size()) >= enough) break;
    front = next_ring(body, faces, front);
    std::erase_if(front, [&](std::uint32_t f) { return glm::dot(normal_of(body.mesh, f), normal) < least_cosine; });
    if (front.empty()) break;
    faces.insert(faces.end(), front.begin(), front.end());
    make_set(faces);
  }
  return faces;
}

std::uint32_t degree_for(std::uint32_t most, std::size_t vertices) {
  while (most > 1 && static_cast<double>(vertices) < vertices_per_term * static_cast<double>(terms_of(most)))
    --most;
  return most;
}

std::size_t place_in(const std::vector<std::uint32_t>& set, std::uint32_t item) {
  return static_cast<std::size_t>(std::lower_bound(set.begin(), set.end(), item) - set.begin());
}

}  // namespace

/// A face's fit while it is made: `factors[vertex * terms + term]`.
struct SurfaceFit::Made {
  Fit fit;
  std::vector<std::uint32_t> vertices;
  std::vector<double> factors;

  std::size_t terms() const { return terms_of(fit.degree); }
  Monomials at(const Vec3& point) const {
    const Vec3 from = point - fit.origin;
    return monomials(fit.degree, glm::dot(from, fit.s), glm::dot(from, fit.t));
  }

  /// To the linear elements, over the area of these faces.
  void to_areas(const Patches& body, const std::vector<std::uint32_t>& faces) {
    vertices = vertices_of(body.mesh, faces);
    fit.degree = degree_for(edge_degree, vertices.size());
    factors.assign(vertices.size() * terms(), 0);
    LeastSquares squares(terms());
    const double scale2 = glm::dot(fit.s, fit.s);
    for (const std::uint32_t face : faces) {
      const Patch& patch = body.patches[face];
      std::array<std::size_t, 3> place;
      for (std::size_t i = 0; i < 3; ++i)
        place[i] = place_in(vertices, body.mesh.triangles[face][static_cast<int>(i)]);
      for (const TriangleSample& q : six_point_rule()) {
        const Vec3 from = patch.at(q.u, q.v) - fit.origin;
        // The rim counts next to nothing.
        const double in = std::max(0.0, 1 - glm::dot(from, from) * scale2 / (1.05 * 1.05));
        const double weight = q.weight * glm::length(patch.area_vector(q.u, q.v)) * scale2 * (in * in + 1e-4);
        const Monomials row = at(patch.at(q.u, q.v));
        squares.add(row, weight);
        const std::array<double, 3> hat{1 - q.u - q.v, q.u, q.v};
        for (std::size_t c = 0; c < 3; ++c) {
          for (std::size_t i = 0; i < terms(); ++i)
            factors[place[c] * terms() + i] += weight * hat[c] * row[i];
        }
      }
    }
    solve(squares);
  }

  /// To the hat averages of the vertices of these faces, without those next to a sharp edge or around a bend. Returns
  /// false if they are too few.
  bool to_averages(const Patches& body, const std::vector<std::uint32_t>& faces, const Vec3& normal, double side) {
    const std::vector<std::uint32_t> reached = with_next_ring(body, faces);
    vertices = vertices_of(body.mesh, faces);
    std::vector<std::uint32_t> beyond;
    for (const std::uint32_t face : reached) {
      if (glm::dot(normal_of(body.mesh, face), normal) >= least_hat_cosine) continue;
      const glm::uvec3& t = body.mesh.triangles[face];
      beyond.insert(beyond.end(), {t.x, t.y, t.z});
    }
    make_set(beyond);
    for (const std::uint32_t face : reached) {
      for (std::uint32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
        if (!body.sharp[corner]) continue;
        const auto ends = geometry::side_vertices(body.mesh, corner);
        beyond.insert(beyond.end(), ends.begin(), ends.end());
      }
    }
    make_set(beyond);
    std::erase_if(vertices, [&](std::uint32_t v) { return contains(beyond, v); });
    if (static_cast<double>(vertices.size()) < vertices_per_term * static_cast<double>(terms_of(2))) return false;
    fit.degree = degree_for(smooth_degree, vertices.size());
    fit.averaged = true;

    std::vector<Monomials> rows(vertices.size(), Monomials{});
    std::vector<double> areas(vertices.size()), cosines(vertices.size());
    for (const std::uint32_t face : reached) {
      const Patch& patch = body.patches[face];
      const glm::uvec3& t = body.mesh.triangles[face];
      if (std::ranges::none_of(std::array{t.x, t.y, t.z}, [&](std::uint32_t v) { return contains(vertices, v); }))
        continue;
      for (const TriangleSample& q : six_point_rule()) {
        const Vec3 area = q.weight * patch.area_vector(q.u, q.v);
        const Monomials there = at(patch.at(q.u, q.v));
        const std::array<double, 3> hat{1 - q.u - q.v, q.u, q.v};
        for (std::size_t c = 0; c < 3; ++c) {
          const std::size_t place = place_in(vertices, t[static_cast<int>(c)]);
          if (place == vertices.size() || vertices[place] != t[static_cast<int>(c)]) continue;
          const double weight = hat[c] * glm::length(area);
          areas[place] += weight;
          cosines[place] += hat[c] * glm::dot(area, normal);
          for (std::size_t i = 0; i < terms(); ++i)
            rows[place][i] += weight * there[i];
        }
      }
    }
    LeastSquares squares(terms());
    factors.assign(vertices.size() * terms(), 0);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      for (double& entry : rows[v])
        entry /= areas[v];
      const Vec3 from = body.mesh.positions[vertices[v]] - fit.origin;
      const double cosine = std::max(cosines[v] / areas[v], least_weight_cosine);
      const double weight =
          areas[v] / (side * side) * std::exp(-glm::dot(from, from) / (side * side)) * cosine * cosine;
      squares.add(rows[v], weight);
      for (std::size_t i = 0; i < terms(); ++i)
        factors[v * terms() + i] = weight * rows[v][i];
    }
    solve(squares);
    return true;
  }

 private:
  static std::vector<std::uint32_t> with_next_ring(const Patches& body, const std::vector<std::uint32_t>& faces) {
    std::vector<std::uint32_t> all = next_ring(body, faces, faces);
    all.insert(all.end(), faces.begin(), faces.end());
    make_set(all);
    return all;
  }

  void solve(LeastSquares& squares) {
    squares.factor();
    for (std::size_t v = 0; v < vertices.size(); ++v)
      squares.solve(std::span(factors).subspan(v * terms(), terms()));
  }
};

SurfaceFit::Made SurfaceFit::make(const Patches& body, std::uint32_t face) {
  const Patch& own = body.patches[face];
  const Vec3 area = own.area_vector(1.0 / 3, 1.0 / 3), normal = glm::normalize(area);
  const std::vector<std::uint32_t> faces = faces_of_fit(body, face, normal);
  Made made;
  made.fit.origin = own.at(1.0 / 3, 1.0 / 3);
  double radius2 = 0;
  for (const std::uint32_t v : vertices_of(body.mesh, faces)) {
    const Vec3 from = body.mesh.positions[v] - made.fit.origin;
    radius2 = std::max(radius2, glm::dot(from, from));
  }
  const Vec3 s = glm::normalize(own.along_u(1.0 / 3, 1.0 / 3));
  made.fit.s = s / std::sqrt(radius2);
  made.fit.t = glm::cross(normal, s) / std::sqrt(radius2);
  // The side of an equilateral triangle of this area; the area vector is twice the area.
  const double side = std::sqrt(2 / std::sqrt(3.0) * glm::length(area));
  if (is_edged(body, faces) || !made.to_averages(body, faces, normal, side)) {
    made.fit.averaged = false;
    made.to_areas(body, faces);
  }
  return made;
}

SurfaceFit::SurfaceFit(const Patches& body) : averages_(body), positions_(body.mesh.positions) {
  const std::size_t count = body.patches.size();
  std::vector<std::vector<Made>> chunks(chunk_count(count, 64));
  parallel_chunks(count, 64, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face)
      chunks[chunk].push_back(make(body, static_cast<std::uint32_t>(face)));
  });
  for (std::vector<Made>& chunk : chunks) {
    for (Made& made : chunk) {
      made.fit.first_vertex = vertices_.size();
      made.fit.first_factor = factors_.size();
      made.fit.vertices = static_cast<std::uint32_t>(made.vertices.size());
      fits_.push_back(made.fit);
      vertices_.insert(vertices_.end(), made.vertices.begin(), made.vertices.end());
      factors_.insert(factors_.end(), made.factors.begin(), made.factors.end());
    }
    std::vector<Made>().swap(chunk);
  }
  for (const glm::uvec3& t : body.mesh.triangles)
    corners_.push_back({t.x, t.y, t.z});
}

void SurfaceFit::polynomial(const Fit& fit, std::span<const std::complex<float>> solution,
                            std::span<const Complex> averages, std::span<Complex> coefficients) const {
  const std::size_t terms = terms_of(fit.degree);
  std::array<double, most_terms> re{}, im{};
  for (std::size_t v = 0; v < fit.vertices; ++v) {
    const std::uint32_t vertex = vertices_[fit.first_vertex + v];
    const Complex number = !fit.averaged      ? Complex(solution[vertex])
                           : averages.empty() ? averages_.at(vertex, solution)
                                              : averages[vertex];
    const float* const factor = &factors_[fit.first_factor + v * terms];
    for (std::size_t i = 0; i < terms; ++i) {
      re[i] += static_cast<double>(factor[i]) * number.real();
      im[i] += static_cast<double>(factor[i]) * number.imag();
    }
  }
  for (std::size_t i = 0; i < terms; ++i)
    coefficients[i] = {re[i], im[i]};
}

FaceSound SurfaceFit::value(const Fit& fit, std::span<const Complex> polynomial, const Vec3& point,
                            const Vec3& normal) {
  const Vec3 from = point - fit.origin;
  const double s = glm::dot(from, fit.s), t = glm::dot(from, fit.t);
  const Monomials at = monomials(fit.degree, s, t);
  const MonomialSlopes slopes = monomial_slopes(fit.degree, s, t);
  FaceSound sound{};
  Complex along_s = 0, along_t = 0;
  for (std::size_t i = 0; i < terms_of(fit.degree); ++i) {
    sound.pressure += polynomial[i] * at[i];
    along_s += polynomial[i] * slopes.by_s[i];
    along_t += polynomial[i] * slopes.by_t[i];
  }
  const Vec3 s_here = fit.s - glm::dot(fit.s, normal) * normal, t_here = fit.t - glm::dot(fit.t, normal) * normal;
  for (int axis = 0; axis < 3; ++axis)
    sound.gradient[static_cast<std::size_t>(axis)] = along_s * s_here[axis] + along_t * t_here[axis];
  return sound;
}

SkinSound SurfaceFit::on(const Patches& body, std::span<const std::complex<float>> solution) const {
  const std::vector<Complex> averages = averages_.of(solution);
  const auto rule = three_point_rule();
  SkinSound sound;
  sound.faces.resize(fits_.size());
  sound.samples.resize(fits_.size() * rule.size());
  parallel_chunks(fits_.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::array<Complex, most_terms> coefficients;
    for (std::size_t face = begin; face < end; ++face) {
      const Fit& fit = fits_[face];
      polynomial(fit, solution, averages, coefficients);
      sound.faces[face] = value(fit, coefficients, fit.origin, glm::normalize(glm::cross(fit.s, fit.t)));
      const Patch& patch = body.patches[face];
      for (std::size_t q = 0; q < rule.size(); ++q) {
        sound.samples[face * rule.size() + q] = value(fit, coefficients, patch.at(rule[q].u, rule[q].v),
                                                      glm::normalize(patch.area_vector(rule[q].u, rule[q].v)));
      }
    }
  });
  return sound;
}

std::vector<FaceSound> SurfaceFit::at_faces(std::span<const std::complex<float>> solution) const {
  const std::vector<Complex> averages = averages_.of(solution);
  std::vector<FaceSound> sounds(fits_.size());
  parallel_chunks(sounds.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::array<Complex, most_terms> coefficients;
    for (std::size_t face = begin; face < end; ++face) {
      const Fit& fit = fits_[face];
      polynomial(fit, solution, averages, coefficients);
      sounds[face] = value(fit, coefficients, fit.origin, glm::normalize(glm::cross(fit.s, fit.t)));
    }
  });
  return sounds;
}

FaceSound SurfaceFit::at(std::size_t face, const Vec3& point, const Vec3& normal,
                         std::span<const std::complex<float>> solution) const {
  const Fit& fit = fits_[face];
  std::array<Complex, most_terms> coefficients;
  polynomial(fit, solution, {}, coefficients);
  return value(fit, coefficients, point, normal);
}

void SurfaceFit::add_pressure_row(std::uint32_t face, std::span<std::complex<float>> row) const {
  add_pressure_row(face, fits_[face].origin, row);
}

void SurfaceFit::add_pressure_row(std::uint32_t face, const Vec3& at, std::span<std::complex<float>> row) const {
  const Fit& fit = fits_[face];
  const Vec3 from = at - fit.origin;
  const std::size_t terms = terms_of(fit.degree);
  const Monomials by = monomials(fit.degree, glm::dot(from, fit.s), glm::dot(from, fit.t));
  for (std::size_t v = 0; v < fit.vertices; ++v) {
    double sum = 0;
    for (std::size_t i = 0; i < terms; ++i)
      sum += by[i] * static_cast<double>(factors_[fit.first_factor + v * terms + i]);
    const std::uint32_t vertex = vertices_[fit.first_vertex + v];
    if (fit.averaged) {
      averages_.add_row(vertex, sum, row);
    } else {
      row[vertex] += static_cast<float>(sum);
    }
  }
}

std::vector<std::complex<double>> SurfaceFit::at_vertices(std::span<const std::complex<float>> solution) const {
  const std::vector<Complex> averages = averages_.of(solution);
  std::vector<Complex> sums(positions_.size());
  std::vector<double> faces(positions_.size());
  std::array<Complex, most_terms> coefficients;
  for (std::size_t face = 0; face < fits_.size(); ++face) {
    const Fit& fit = fits_[face];
    polynomial(fit, solution, averages, coefficients);
    for (const std::uint32_t vertex : corners_[face]) {
      const Vec3 normal = glm::normalize(glm::cross(fit.s, fit.t));
      sums[vertex] += value(fit, coefficients, positions_[vertex], normal).pressure;
      ++faces[vertex];
    }
  }
  for (std::size_t vertex = 0; vertex < sums.size(); ++vertex)
    sums[vertex] /= faces[vertex];
  return sums;
}

}  // namespace palpa::acoustics
