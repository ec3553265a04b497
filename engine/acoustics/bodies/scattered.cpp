// The sound that a body sends into the air: the double layer of the pressure on its surface.
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numbers>

#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "base/activity.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {

using Complex = std::complex<double>;

namespace {

/// A patch nearer than this many times its longest side is divided into four, recursively.
constexpr double near_sides = 2;
constexpr int most_cuts = 12;

/// The sound of a part of a patch at a point: the patch's pressure is linear in its u and v.
class SubPatch {
 public:
  SubPatch(const Patch& patch, const std::array<Complex, 3>& at_corners, const Vec3& point, double wave_number)
      : patch_(patch), at_corners_(at_corners), point_(point), wave_number_(wave_number) {}

  /// The sound of the part with these corners in (u, v).
  Complex sum(const Vec2& a, const Vec2& b, const Vec2& c, int cuts) const {
    const Vec2 middle = (a + b + c) / 3.0;
    const Vec3 pa = at(a), pb = at(b), pc = at(c);
    const double size = std::max({glm::distance(pa, pb), glm::distance(pb, pc), glm::distance(pc, pa)});
    if (glm::distance(point_, at(middle)) > near_sides * size || cuts == most_cuts) return by_samples(a, b, c);
    const Vec2 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
    return sum(a, ab, ca, cuts + 1) + sum(ab, b, bc, cuts + 1) + sum(ca, bc, c, cuts + 1) + sum(bc, ca, ab, cuts + 1);
  }

 private:
  Vec3 at(const Vec2& uv) const { return patch_.at(uv.x, uv.y); }

  Complex by_samples(const Vec2& a, const Vec2& b, const Vec2& c) const {
    const Vec2 u = b - a, v = c - a;
    const double scale = u.x * v.y - u.y * v.x;
    Complex total = 0;
    for (const TriangleSample& s : six_point_rule()) {
      const Vec2 uv = a + s.u * u + s.v * v;
      const Vec3 way = at(uv) - point_;
      const double r = glm::length(way);
      const Complex g = std::polar(1 / (4 * std::numbers::pi * r), wave_number_ * r);
      const double towards = glm::dot(way, patch_.area_vector(uv.x, uv.y)) / r;
      const Complex pressure = (1 - uv.x - uv.y) * at_corners_[0] + uv.x * at_corners_[1] + uv.y * at_corners_[2];
      total += s.weight * scale * towards * Complex(-1 / r, wave_number_) * g * pressure;
    }
    return total;
  }

  const Patch& patch_;
  const std::array<Complex, 3>& at_corners_;
  Vec3 point_;
  double wave_number_;
};

}  // namespace

RigidBody::Row RigidBody::row_in_air(const Vec3& at) const {
  // The sound there of each corner's hat function alone.
  constexpr std::array<std::array<Complex, 3>, 3> hats{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::vector<Complex> sums(mesh().positions.size());
  for (std::size_t face = 0; face < mesh().triangles.size(); ++face) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      sums[mesh().triangles[face][static_cast<int>(corner)]] +=
          SubPatch(patches_.patches[face], hats[corner], at, wave_number_).sum({0, 0}, {1, 0}, {0, 1}, 0);
    }
  }
  return {sums.begin(), sums.end()};
}

std::vector<Complex> RigidBody::scattered(std::span<const std::complex<float>> unknowns,
                                          std::span<const Vec3> points) const {
  const std::size_t faces = mesh().triangles.size();
  // For each face: the sphere within which it is near, and the pressures of its corners.
  std::vector<double> reach(faces);
  std::vector<Vec3> centres(faces);
  std::vector<std::array<Complex, 3>> corners(faces);
  const Vec3 origin = geometry::bounds(mesh()).centre();
  std::vector<LayerGroup> groups((faces + far_lanes - 1) / far_lanes);
  for (std::size_t f = 0; f < groups.size() * far_lanes; ++f) {
    LayerGroup& group = groups[f / far_lanes];
    const std::size_t lane = f % far_lanes;
    if (f >= faces) {
      for (auto& sample : group.of)
        sample[0][lane] = sample[1][lane] = sample[2][lane] = 1e3F;
      continue;
    }
    const glm::uvec3& t = mesh().triangles[f];
    const Vec3 &a = mesh().positions[t.x], &b = mesh().positions[t.y], &c = mesh().positions[t.z];
    centres[f] = (a + b + c) / 3.0;
    reach[f] = near_sides * std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    corners[f] = {Complex(unknowns[t.x]), Complex(unknowns[t.y]), Complex(unknowns[t.z])};
    for (std::size_t q = 0; q < 3; ++q) {
      const TriangleSample& s = three_point_rule()[q];
      const Vec3 at = patches_.patches[f].at(s.u, s.v) - origin;
      const Vec3 area = s.weight * patches_.patches[f].area_vector(s.u, s.v);
      const Complex p = (1 - s.u - s.v) * corners[f][0] + s.u * corners[f][1] + s.v * corners[f][2];
      const std::array<double, layer_numbers> numbers{at.x, at.y, at.z, area.x, area.y, area.z, p.real(), p.imag()};
      for (std::size_t i = 0; i < layer_numbers; ++i)
        group.of[q][i][lane] = static_cast<float>(numbers[i]);
    }
  }
  std::vector<Complex> sums(points.size());
  Activity activity("summing the sound of the surface", points.size());
  parallel_chunks(points.size(), 64, [&](std::size_t, std::size_t begin, std::size_t end) {
    LayerSums parts;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 at = points[i] - origin;
      const std::array<float, 3> from{static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
      const Complex arrival = std::polar(1.0, wave_number_ * glm::length(at));
      Complex from_afar = 0, from_near = 0;
      for (std::size_t g = 0; g < groups.size(); ++g) {
        layer_sums(from, groups[g], static_cast<float>(wave_number_), parts);
        for (std::size_t lane = 0; lane < std::min(far_lanes, faces - g * far_lanes); ++lane) {
          const std::size_t f = g * far_lanes + lane;
          const Vec3 way = points[i] - centres[f];
          if (glm::dot(way, way) > reach[f] * reach[f]) {
            from_afar += Complex(parts.of[0][lane], parts.of[1][lane]);
          } else {
            from_near +=
                SubPatch(patches_.patches[f], corners[f], points[i], wave_number_).sum({0, 0}, {1, 0}, {0, 1}, 0);
          }
        }
      }
      sums[i] = arrival * from_afar + from_near;
    }
    activity.advance(end - begin);
  });
  return sums;
}

}  // namespace palpa::acoustics
