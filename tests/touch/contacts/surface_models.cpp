#include "touch/contacts/surface_models.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "support/shapes.hpp"

namespace palpa::touch::test {
namespace {

using geometry::Mesh;
using palpa::test::box;
using palpa::test::sphere;
using palpa::test::transformed;
constexpr double pi = std::numbers::pi;

using Index = std::uint32_t;

}  // namespace

Mesh notched_cube() {
  // The outline of z = const, counter-clockwise, and its triangles.
  const std::vector<Vec2> outline{{-0.02, -0.04},   {0.02, -0.04},     {0.02, 0},    {0.0075, 0},
                                  {0.0075, -0.015}, {-0.0075, -0.015}, {-0.0075, 0}, {-0.02, 0}};
  const std::vector<glm::uvec3> lid{{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}};
  Mesh mesh;
  for (const double z : {-0.02, 0.02}) {
    for (const Vec2& p : outline)
      mesh.positions.emplace_back(p.x, p.y, z);
  }
  const auto n = static_cast<Index>(outline.size());
  for (Index i = 0; i < n; ++i) {
    const Index k = (i + 1) % n;
    mesh.triangles.emplace_back(i, k, k + n);
    mesh.triangles.emplace_back(i, k + n, i + n);
  }
  for (const glm::uvec3& t : lid) {
    mesh.triangles.emplace_back(t.x, t.z, t.y);
    mesh.triangles.emplace_back(t.x + n, t.y + n, t.z + n);
  }
  return mesh;
}

Mesh hollow_ball() {
  Mesh mesh = sphere(0.02, 24, 40), inner = sphere(0.015, 16, 31);
  geometry::flip(inner);
  geometry::append(mesh, inner);
  // Its poles on y: cameras look down at one.
  return transformed(mesh, [](const Vec3& p) { return Vec3(p.x, p.z, -p.y); });
}

Mesh thin_plate() {
  return box({-0.04, -0.0004, -0.03}, {0.04, 0, 0.03});
}

Mesh needle_cylinder(int segments) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, -0.06, 0}};
  for (int k = 0; k < segments; ++k) {
    const double a = 2 * pi * k / segments;
    mesh.positions.emplace_back(0.01 * std::cos(a), 0, -0.01 * std::sin(a));
    mesh.positions.emplace_back(0.01 * std::cos(a), -0.06, -0.01 * std::sin(a));
  }
  for (int k = 0; k < segments; ++k) {
    const auto top = static_cast<Index>(2 + 2 * k), bottom = top + 1;
    const auto next_top = static_cast<Index>(2 + 2 * ((k + 1) % segments)), next_bottom = next_top + 1;
    mesh.triangles.emplace_back(0, top, next_top);
    mesh.triangles.emplace_back(1, next_bottom, bottom);
    mesh.triangles.emplace_back(top, bottom, next_top);
    mesh.triangles.emplace_back(next_top, bottom, next_bottom);
  }
  return mesh;
}

Mesh spikes() {
  std::vector<Vec2> outline;
  std::vector<glm::uvec3> lid;
  for (Index i = 0; i < 24; ++i) {
    const double angle = 2 * pi * i / 24;
    outline.push_back((i % 2 == 0 ? 0.040 : 0.018) * Vec2(std::cos(angle), std::sin(angle)));
    if (i % 2 == 0) lid.emplace_back((i + 23) % 24, i, i + 1);
    if (i % 2 == 0 && i >= 2 && i < 22) lid.emplace_back(1, i + 1, i + 3);
  }
  return palpa::test::prism(outline, lid, 0, 0.025);
}

Mesh star() {
  return transformed(sphere(1, 60, 90), [](const Vec3& d) {
    const double ridges = std::sin(9 * std::atan2(d.y, d.x)) * (1 - d.z * d.z);
    return d * (0.030 + 0.006 * ridges + 0.003 * std::cos(11 * std::acos(std::clamp(d.z, -1.0, 1.0))));
  });
}

Mesh tilted(const Mesh& mesh, const Vec3& shift) {
  const glm::dmat3 turn(0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6);
  return palpa::test::rounded(transformed(mesh, [&](const Vec3& p) { return turn * p + shift; }));
}

std::vector<glm::vec3> points_near(const Mesh& mesh, std::uint32_t count, unsigned seed) {
  std::vector<double> area;
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    sum += glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
    area.push_back(sum);
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> bell(0, 1);
  std::vector<glm::vec3> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto place = std::upper_bound(area.begin(), area.end(), unit(random) * sum) - area.begin();
    const glm::uvec3& t = mesh.triangles[static_cast<std::size_t>(
        std::min<std::ptrdiff_t>(place, static_cast<std::ptrdiff_t>(mesh.triangles.size()) - 1))];
    double a = unit(random), b = unit(random);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    Vec3 p = mesh.positions[t.x] * (1 - a - b) + mesh.positions[t.y] * a + mesh.positions[t.z] * b;
    // Some right at the surface, most within a few millimetres of it.
    const double far = i % 8 == 0 ? 1e-5 : 1.2e-3;
    p += far * Vec3(bell(random), bell(random), bell(random));
    points.emplace_back(p);
  }
  return points;
}

Truth::Truth(const Mesh& mesh) : mesh_(&mesh), box_(geometry::bounds(mesh)) {
  const Vec3 extent = box_.high - box_.low;
  side_ = std::max({extent.x, extent.y, extent.z}) / 64;
  nx_ = static_cast<int>(extent.x / side_) + 1;
  ny_ = static_cast<int>(extent.y / side_) + 1;
  nz_ = static_cast<int>(extent.z / side_) + 1;
  bins_.resize(static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_));
  cells_.resize(bins_.size() * static_cast<std::size_t>(nx_));
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    Box box;
    for (int k = 0; k < 3; ++k)
      box.add(mesh.positions[mesh.triangles[t][k]]);
    const glm::ivec3 low((box.low - box_.low) / side_), high((box.high - box_.low) / side_);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        bins_[bin(y, z)].push_back(t);
        for (int x = low.x; x <= high.x; ++x)
          cells_[cell(x, y, z)].push_back(t);
      }
    }
  }
}

std::size_t Truth::bin(int y, int z) const {
  return static_cast<std::size_t>(std::clamp(z, 0, nz_ - 1)) * static_cast<std::size_t>(ny_) +
         static_cast<std::size_t>(std::clamp(y, 0, ny_ - 1));
}

std::size_t Truth::cell(int x, int y, int z) const {
  return bin(y, z) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(std::clamp(x, 0, nx_ - 1));
}

namespace {

/// Nearest point of a triangle by the regions of Ericson, Real-Time Collision Detection, 5.1.5.
Vec3 nearest(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double all = va + vb + vc;
  return a + ab * (vb / all) + ac * (vc / all);
}

}  // namespace

double Truth::distance(const Vec3& p) const {
  const glm::ivec3 at(glm::floor((p - box_.low) / side_));
  double best2 = 1e300;
  for (int ring = 0; ring < 200; ++ring) {
    // What lies in farther rings is at least that far away.
    const double beyond = (ring - 1) * side_;
    if (ring > 0 && beyond > 0 && beyond * beyond > best2) break;
    if (beyond > 0.02) break;
    for (int z = at.z - ring; z <= at.z + ring; ++z) {
      for (int y = at.y - ring; y <= at.y + ring; ++y) {
        const bool edge = std::abs(z - at.z) == ring || std::abs(y - at.y) == ring;
        for (int x = at.x - ring; x <= at.x + ring; x += edge || ring == 0 ? 1 : 2 * ring) {
          if (x < 0 || y < 0 || z < 0 || x >= nx_ || y >= ny_ || z >= nz_) continue;
          const Vec3 low = box_.low + Vec3(x, y, z) * side_;
          const Vec3 away = p - glm::clamp(p, low, low + side_);
          if (glm::dot(away, away) > best2 * (1 + 1e-6)) continue;
          for (const Index t : cells_[cell(x, y, z)]) {
            const glm::uvec3& v = mesh_->triangles[t];
            const Vec3 apart = p - nearest(p, mesh_->positions[v.x], mesh_->positions[v.y], mesh_->positions[v.z]);
            best2 = std::min(best2, glm::dot(apart, apart));
          }
        }
      }
    }
  }
  return std::sqrt(best2);
}

bool Truth::winds(const Vec3& p) const {
  double sum = 0;
  for (const glm::uvec3& v : mesh_->triangles) {
    const Vec3 a = mesh_->positions[v.x] - p, b = mesh_->positions[v.y] - p, c = mesh_->positions[v.z] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += std::atan2(glm::dot(a, glm::cross(b, c)),
                      la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (2 * pi) > 0.5;
}

int Truth::crossings(const Vec3& p) const {
  if (p.y < box_.low.y || p.y > box_.high.y || p.z < box_.low.z || p.z > box_.high.z) return 0;
  int count = 0;
  for (const Index t :
       bins_[bin(static_cast<int>((p.y - box_.low.y) / side_), static_cast<int>((p.z - box_.low.z) / side_))]) {
    const glm::uvec3& v = mesh_->triangles[t];
    const Vec3 &a = mesh_->positions[v.x], &b = mesh_->positions[v.y], &c = mesh_->positions[v.z];
    const auto turn = [&](const Vec3& s, const Vec3& e) {
      return (e.y - s.y) * (p.z - s.z) - (e.z - s.z) * (p.y - s.y);
    };
    const double u = turn(b, c), w = turn(c, a), q = turn(a, b);
    const double size = std::abs(u) + std::abs(w) + std::abs(q);
    const double least = 1e-9 * size + 1e-18;
    const bool positive = u > least && w > least && q > least, negative = u < -least && w < -least && q < -least;
    if (!positive && !negative) {
      const bool outside = (u > least || w > least || q > least) && (u < -least || w < -least || q < -least);
      if (outside) continue;
      return -1;
    }
    const double x = (u * a.x + w * b.x + q * c.x) / (u + w + q);
    if (std::abs(x - p.x) < 1e-9) return -1;
    if (x > p.x) ++count;
  }
  return count;
}

double Truth::depth(const Vec3& p, bool thorough) const {
  const int through = thorough ? -1 : crossings(p);
  const bool inside = through < 0 ? winds(p) : through % 2 == 1;
  return inside ? distance(p) : -distance(p);
}

}  // namespace palpa::touch::test
