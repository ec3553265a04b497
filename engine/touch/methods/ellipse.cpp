#include "touch/methods/ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace palpa::touch {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;
using Column = std::array<double, 3>;

constexpr double turn = 2 * std::numbers::pi;

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return c;
}

Matrix transposed(const Matrix& a) {
  return {{{a[0][0], a[1][0], a[2][0]}, {a[0][1], a[1][1], a[2][1]}, {a[0][2], a[1][2], a[2][2]}}};
}

Column operator*(const Matrix& a, const Column& v) {
  Column r{};
  for (std::size_t i = 0; i < 3; ++i)
    r[i] = a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2];
  return r;
}

double trace(const Matrix& a) {
  return a[0][0] + a[1][1] + a[2][2];
}

/// Inverse of the lower triangular L with L L^T = `a`; empty if `a` is not positive definite.
std::optional<Matrix> inverse_cholesky(const Matrix& a) {
  Matrix lower{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double rest = a[i][j];
      for (std::size_t k = 0; k < j; ++k)
        rest -= lower[i][k] * lower[j][k];
      if (i != j) {
        lower[i][j] = rest / lower[j][j];
      } else if (rest > 0) {
        lower[i][i] = std::sqrt(rest);
      } else {
        return std::nullopt;
      }
    }
  }
  Matrix inverse{};
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = j; i < 3; ++i) {
      double rest = i == j ? 1 : 0;
      for (std::size_t k = j; k < i; ++k)
        rest -= lower[i][k] * inverse[k][j];
      inverse[i][j] = rest / lower[i][i];
    }
  }
  return inverse;
}

/// Eigenvector of the largest eigenvalue of a symmetric matrix: cyclic Jacobi. geometry::eigen_of multiplies in another
/// order and stops earlier. With it, most vectors, and so the foci, would differ in their last bits.
Column largest_eigenvector(Matrix a) {
  Matrix v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int turn_number = 0; turn_number < 60; ++turn_number) {
    const std::size_t p = turn_number % 3 == 2 ? 1 : 0, q = turn_number % 3 == 0 ? 1 : 2;
    if (a[p][q] == 0) continue;
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(theta, 1.0));
    const double c = 1 / std::hypot(t, 1.0), s = t * c;
    Matrix rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    rotation[p][p] = rotation[q][q] = c;
    rotation[p][q] = s;
    rotation[q][p] = -s;
    a = transposed(rotation) * a * rotation;
    v = v * rotation;
  }
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 3; ++i)
    largest = a[i][i] > a[largest][largest] ? i : largest;
  return {v[0][largest], v[1][largest], v[2][largest]};
}

/// The ellipse whose shape's square is the given matrix, if that is positive definite. For a symmetric 2 x 2 matrix B,
/// sqrt(B) = (B + sqrt(|B|)) / sqrt(tr B + 2 sqrt(|B|)).
std::optional<Ellipse> around(const Vec2& centre, double xx, double xy, double yy) {
  const double root = std::sqrt(std::max(0.0, xx * yy - xy * xy)), scale = 1 / std::sqrt(xx + yy + 2 * root);
  const Ellipse ellipse{centre, (xx + root) * scale, xy * scale, (yy + root) * scale};
  const bool finite = std::isfinite(ellipse.xx) && std::isfinite(ellipse.xy) && std::isfinite(ellipse.yy);
  if (!(root > 0) || !finite) return std::nullopt;
  return ellipse;
}

/// The ellipse of a x^2 + b x y + c y^2 + d x + e y + f = 0, if it is one.
std::optional<Ellipse> ellipse_of(const Column& quadratic, const Column& linear) {
  const auto& [a, b, c] = quadratic;
  const auto& [d, e, f] = linear;
  const double determinant = 4 * a * c - b * b;
  const Vec2 centre((b * e - 2 * c * d) / determinant, (b * d - 2 * a * e) / determinant);
  // (p - centre)^T Q (p - centre) = 1
  const double level = -(f + (d * centre.x + e * centre.y) / 2);
  const double xx = a / level, xy = b / (2 * level), yy = c / level;
  const double area = xx * yy - xy * xy;
  if (!(xx > 0) || !(area > 0) || !std::isfinite(centre.x) || !std::isfinite(centre.y)) return std::nullopt;
  return around(centre, yy / area, -xy / area, xx / area);
}

}  // namespace

SectionPlane::SectionPlane(const CrossSection& section)
    : centroid_(section.centroid),
      along1_(section.axes[0]),
      along2_(-Vec3(section.axes[1])),
      unit_(std::sqrt(double{section.eigenvalues[0]} + double{section.eigenvalues[1]})) {}

Vec2 SectionPlane::flat(const glm::vec3& p) const {
  const Vec3 d = (Vec3(p) - centroid_) / unit_;
  return {glm::dot(along1_, d), glm::dot(along2_, d)};
}

glm::vec3 SectionPlane::raised(const Vec2& p) const {
  return glm::vec3(centroid_ + unit_ * (p.x * along1_ + p.y * along2_));
}

Vec2 Ellipse::at(double t) const {
  const double c = std::cos(t), s = std::sin(t);
  return centre + Vec2(xx * c + xy * s, xy * c + yy * s);
}

double Ellipse::parameter_of(const Vec2& p) const {
  const Vec2 d = p - centre;
  const double x = yy * d.x - xy * d.y, y = xx * d.y - xy * d.x;  // the inverse up to its positive determinant
  if (x == 0 && y == 0) return 0;
  const double t = std::atan2(y, x);
  return t < 0 ? std::max(0.0, t + turn) : t;
}

double Ellipse::semi_major() const {
  return (xx + yy) / 2 + std::hypot((xx - yy) / 2, xy);
}

void PlaneMoments::add(const Vec2& p) {
  double x = 1;
  for (std::size_t i = 0; i < 5; ++i, x *= p.x) {
    double term = x;
    for (std::size_t j = 0; i + j < 5; ++j, term *= p.y)
      sums[i][j] += term;
  }
}

std::optional<Ellipse> fit_ellipse(const PlaneMoments& moments) {
  const auto& m = moments.sums;
  if (m[0][0] < 6) return std::nullopt;
  // Scatter of (x^2, x y, y^2) and (x, y, 1) among and with each other.
  const Matrix quadratic{{{m[4][0], m[3][1], m[2][2]}, {m[3][1], m[2][2], m[1][3]}, {m[2][2], m[1][3], m[0][4]}}};
  const Matrix mixed{{{m[3][0], m[2][1], m[2][0]}, {m[2][1], m[1][2], m[1][1]}, {m[1][2], m[0][3], m[0][2]}}};
  const Matrix linear{{{m[2][0], m[1][1], m[1][0]}, {m[1][1], m[0][2], m[0][1]}, {m[1][0], m[0][1], m[0][0]}}};
  const std::optional<Matrix> root = inverse_cholesky(linear);
  if (!root) return std::nullopt;
  // (d, e, f) = eliminate (a, b, c) is optimal for given a, b, c. The remaining sum of squares is a quadratic form in
  // a, b, c.
  const Matrix eliminate = transposed(*root) * (*root * transposed(mixed));
  Matrix rest = mixed * eliminate;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      rest[i][j] = quadratic[i][j] - rest[i][j];
  }
  // Its minimum with 4 a c - b^2 = 1 is the generalized eigenvector of the only positive eigenvalue. For points exactly
  // on an ellipse, the form is zero in one direction; a tiny multiple of the trace on the diagonal keeps the matrix
  // definite.
  const double hair = 1e-13 * trace(quadratic);
  for (std::size_t i = 0; i < 3; ++i)
    rest[i][i] += hair;
  const std::optional<Matrix> whiten = inverse_cholesky(rest);
  if (!whiten) return std::nullopt;
  constexpr Matrix constraint{{{0, 0, 2}, {0, -1, 0}, {2, 0, 0}}};
  const Column abc = transposed(*whiten) * largest_eigenvector(*whiten * constraint * transposed(*whiten));
  const Column def = eliminate * abc;
  return ellipse_of(abc, {-def[0], -def[1], -def[2]});
}

std::optional<Ellipse> ellipse_of_moments(const PlaneMoments& moments) {
  const auto& m = moments.sums;
  const double count = m[0][0];
  if (!(count > 0)) return std::nullopt;
  const Vec2 mean(m[1][0] / count, m[0][1] / count);
  return around(mean, 2 * (m[2][0] / count - mean.x * mean.x), 2 * (m[1][1] / count - mean.x * mean.y),
                2 * (m[0][2] / count - mean.y * mean.y));
}

ArcSteps::ArcSteps(const Ellipse& ellipse) {
  Vec2 last = ellipse.at(0);
  for (std::size_t i = 1; i <= pieces; ++i) {
    const Vec2 next = ellipse.at(turn * static_cast<double>(i) / pieces);
    along_[i] = along_[i - 1] + glm::distance(last, next);
    last = next;
  }
}

double ArcSteps::parameter_at(double share) const {
  const double length = std::clamp(share, 0.0, 1.0) * along_.back();
  const auto after = std::upper_bound(along_.begin() + 1, along_.end() - 1, length);
  const double before = *(after - 1), step = *after - before;
  const double part = step > 0 ? (length - before) / step : 0;
  return turn * (static_cast<double>(after - 1 - along_.begin()) + part) / pieces;
}

double ArcSteps::share_of(double parameter) const {
  const double place = std::clamp(parameter / turn, 0.0, 1.0) * pieces;
  const auto piece = std::min(static_cast<std::size_t>(place), pieces - 1);
  const double part = place - static_cast<double>(piece);
  return (along_[piece] + part * (along_[piece + 1] - along_[piece])) / along_.back();
}

}  // namespace palpa::touch
