#include "acoustics/boundary/surface_sound.hpp"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>

#include "acoustics/elements/polynomial.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {

SurfaceFit::SurfaceFit(const Patches& body) : averages_(body), positions_(body.mesh.positions) {
  const std::size_t count = body.patches.size();
  fits_.resize(count);
  const FitTables tables(body);
  // Chunks are large, because each has tables of its own for the whole mesh.
  parallel_chunks(count, std::max<std::size_t>(256, count / 64), [&](std::size_t, std::size_t begin, std::size_t end) {
    FitMaker maker(tables);
    for (std::size_t face = begin; face < end; ++face)
      fits_[face] = maker.make(static_cast<std::uint32_t>(face));
  });
  for (const glm::uvec3& t : body.mesh.triangles)
    corners_.push_back({t.x, t.y, t.z});
}

void SurfaceFit::polynomial(const FaceFit& fit, std::span<const std::complex<float>> solution,
                            std::span<const Complex> averages, std::span<Complex> coefficients) const {
  const std::size_t terms = terms_of(fit.degree);
  std::array<double, most_terms> re{}, im{};
  for (std::size_t v = 0; v < fit.vertices.size(); ++v) {
    const std::uint32_t vertex = fit.vertices[v];
    const Complex number = !fit.averaged      ? Complex(solution[vertex])
                           : averages.empty() ? averages_.at(vertex, solution)
                                              : averages[vertex];
    const float* const factor = &fit.factors[v * terms];
    for (std::size_t i = 0; i < terms; ++i) {
      re[i] += static_cast<double>(factor[i]) * number.real();
      im[i] += static_cast<double>(factor[i]) * number.imag();
    }
  }
  for (std::size_t i = 0; i < terms; ++i)
    coefficients[i] = {re[i], im[i]};
}

FaceSound SurfaceFit::value(const FaceFit& fit, std::span<const Complex> polynomial, const Vec3& point,
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
      const FaceFit& fit = fits_[face];
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
      const FaceFit& fit = fits_[face];
      polynomial(fit, solution, averages, coefficients);
      sounds[face] = value(fit, coefficients, fit.origin, glm::normalize(glm::cross(fit.s, fit.t)));
    }
  });
  return sounds;
}

FaceSound SurfaceFit::at(std::size_t face, const Vec3& point, const Vec3& normal,
                         std::span<const std::complex<float>> solution) const {
  const FaceFit& fit = fits_[face];
  std::array<Complex, most_terms> coefficients;
  polynomial(fit, solution, {}, coefficients);
  return value(fit, coefficients, point, normal);
}

void SurfaceFit::add_pressure_row(std::uint32_t face, const Vec3& at, std::span<std::complex<float>> row) const {
  const FaceFit& fit = fits_[face];
  const Vec3 from = at - fit.origin;
  const std::size_t terms = terms_of(fit.degree);
  const Monomials by = monomials(fit.degree, glm::dot(from, fit.s), glm::dot(from, fit.t));
  for (std::size_t v = 0; v < fit.vertices.size(); ++v) {
    double sum = 0;
    for (std::size_t i = 0; i < terms; ++i)
      sum += by[i] * static_cast<double>(fit.factors[v * terms + i]);
    const std::uint32_t vertex = fit.vertices[v];
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
    const FaceFit& fit = fits_[face];
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
