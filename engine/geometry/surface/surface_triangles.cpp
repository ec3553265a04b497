#include "geometry/surface/surface_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/system/parallel.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::geometry {
namespace {

constexpr std::size_t chunk = 16'384;
/// Cosine below which a bend alone decides on which side a point lies.
constexpr double sharp_edge = 0, sharp_corner = 0.3;
/// Sine up to which a bend may count as convex or reflex.
constexpr double flat_bend = 1e-7;
constexpr std::uint32_t none = 0xffffffffU;

struct Face {
  Vec3 normal{0};  // unit; for a needle: its neighbour's
  bool needle = false;
  std::uint8_t longest = 0;  // side
};

std::uint32_t next_side(std::uint32_t side) {
  return side - side % 3 + (side + 1) % 3;
}
std::uint32_t previous_side(std::uint32_t side) {
  return side - side % 3 + (side + 2) % 3;
}

class Preparer {
 public:
  Preparer(const Mesh& mesh, std::span<const std::uint32_t> twin, double needle)
      : mesh_(mesh), twin_(twin), needle_(needle), faces_(mesh.triangles.size()) {}

  SurfaceTriangles run(std::span<const std::uint32_t> order, const Vec3& centre) {
    find_faces();
    borrow_normals();
    SurfaceTriangles out;
    find_fans(out.corners);
    out.triangles.resize(order.size());
    out.signs.resize(order.size());
    parallel_chunks(order.size(), chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        write(order[i], centre, out.triangles[i], out.signs[i]);
    });
    return out;
  }

 private:
  Vec3 start(std::uint32_t side) const { return mesh_.positions[side_vertices(mesh_, side)[0]]; }
  Vec3 along(std::uint32_t side) const {
    const auto [from, to] = side_vertices(mesh_, side);
    return mesh_.positions[to] - mesh_.positions[from];
  }

  void find_faces() {
    parallel_chunks(faces_.size(), chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
        Face& face = faces_[t];
        double longest = -1;
        for (std::uint32_t k = 0; k < 3; ++k) {
          const Vec3 side = along(3 * t + k);
          const double length2 = glm::dot(side, side);
          if (length2 > longest) {
            longest = length2;
            face.longest = static_cast<std::uint8_t>(k);
          }
        }
        const Vec3 twice = area_vector(mesh_, t);
        const double area = glm::length(twice), width = longest > 0 ? area / std::sqrt(longest) : 0;
        face.needle = !(width > needle_);
        if (area > 0) face.normal = twice / area;
      }
    });
  }

  // Goes over the longest sides from needle to needle, until a triangle is wide enough to have a direction.
  void borrow_normals() {
    std::vector<std::pair<std::uint32_t, Vec3>> borrowed;
    for (std::uint32_t t = 0; t < faces_.size(); ++t) {
      if (!faces_[t].needle) continue;
      std::uint32_t from = t;
      for (int step = 0; step < 64 && faces_[from].needle; ++step)
        from = twin_[3 * from + faces_[from].longest] / 3;
      if (faces_[from].needle) from = widest_neighbour(t);
      Vec3 normal = faces_[from].normal;
      if (!(glm::dot(normal, normal) > 0)) normal = Vec3(0, 0, 1);
      borrowed.emplace_back(t, normal);
    }
    for (const auto& [t, normal] : borrowed)
      faces_[t].normal = normal;
  }

  std::uint32_t widest_neighbour(std::uint32_t t) const {
    std::uint32_t best = t;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t other = twin_[3 * t + k] / 3;
      if (!faces_[other].needle) best = other;
    }
    return best;
  }

  // Points out of the triangle, across the side, in the triangle's plane.
  Vec3 outwards(std::uint32_t side) const {
    const Vec3 m = glm::cross(along(side), faces_[side / 3].normal);
    const double length = glm::length(m);
    return length > 0 ? m / length : Vec3(0);
  }

  // Sine of the bend at a side: positive if the edge is convex.
  double bend(std::uint32_t side) const { return glm::dot(faces_[twin_[side] / 3].normal, outwards(side)); }

  void find_fans(std::vector<shader::vec4>& corners) {
    std::vector<double> angle(twin_.size());
    parallel_chunks(faces_.size(), chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t side = 3 * begin; side < 3 * end; ++side) {
        const auto s = static_cast<std::uint32_t>(side);
        const Vec3 a = along(s), b = -along(previous_side(s));
        angle[side] = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      }
    });
    fan_.assign(twin_.size(), none);
    corners.reserve(mesh_.positions.size());
    for (std::uint32_t first = 0; first < twin_.size(); ++first) {
      if (fan_[first] != none) continue;
      const auto fan = static_cast<std::uint32_t>(corners.size());
      Vec3 sum(0);
      std::uint32_t side = first;
      do {  // sides leave the vertex; terminates: each gets its fan once
        fan_[side] = fan;
        sum += angle[side] * faces_[side / 3].normal;
        side = twin_[previous_side(side)];
      } while (fan_[side] == none);
      corners.push_back(corner(first, sum));
    }
  }

  shader::vec4 corner(std::uint32_t first, const Vec3& sum) const {
    const double length = glm::length(sum);
    const Vec3 pseudo = length > 0 ? sum / length : faces_[first / 3].normal;
    double least = 1;
    bool convex = true, reflex = true;
    std::uint32_t side = first, steps = 0;
    do {
      least = std::min(least, glm::dot(pseudo, faces_[side / 3].normal));
      const double sine = bend(side);
      convex = convex && sine >= -flat_bend;
      reflex = reflex && sine <= flat_bend;
      side = twin_[previous_side(side)];
    } while (side != first && ++steps < twin_.size());
    if (least < sharp_corner && convex != reflex) return {0, 0, 0, convex ? 1.0F : -1.0F};
    return {static_cast<float>(pseudo.x), static_cast<float>(pseudo.y), static_cast<float>(pseudo.z), 0};
  }

  std::uint32_t side_word(std::uint32_t side) const {
    const Vec3& mine = faces_[side / 3].normal;
    const Vec3& other = faces_[twin_[side] / 3].normal;
    const double cosine = glm::dot(mine, other), sine = bend(side);
    double across = sine, upwards = 1 + cosine;
    if (cosine < sharp_edge) {
      across = sine >= 0 ? 1 : -1;
      upwards = 0;
    }
    const double scale = 32'767 / std::hypot(across, upwards);
    const auto integer = [](double v) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(v))); };
    return (integer(across * scale) & 0xffffU) | integer(upwards * scale) << 16U;
  }

  void write(std::uint32_t t, const Vec3& centre, shader::SurfaceTriangle& triangle,
             shader::SurfaceSigns& signs) const {
    const Face& face = faces_[t];
    const std::uint32_t side0 = 3 * t + face.longest, side1 = next_side(side0), side2 = next_side(side1);
    const Vec3 a = start(side0);
    const Vec3 first = along(side0);
    const double length0 = glm::length(first);
    Vec3 x = length0 > 0 ? first / length0 : Vec3(1, 0, 0);
    // A needle's own plane is arbitrary; the borrowed normal is made perpendicular to its longest side.
    Vec3 n = face.normal - x * glm::dot(face.normal, x);
    double n_length = glm::length(n);
    if (!(n_length > 1e-3)) {
      n = std::abs(x.x) < 0.7 ? glm::cross(x, Vec3(1, 0, 0)) : glm::cross(x, Vec3(0, 1, 0));
      n_length = glm::length(n);
    }
    n /= n_length;
    const Vec3 y = glm::cross(n, x);
    const Vec3 third = start(side2) - a;
    const Vec2 b(length0, 0), c(glm::dot(third, x), std::max(0.0, glm::dot(third, y)));
    const Vec2 second_side = c - b, third_side = -c;
    const double length1 = glm::length(second_side), length2 = glm::length(third_side);
    const Vec2 d1 = length1 > 0 ? second_side / length1 : Vec2(-1, 0);
    const Vec2 d2 = length2 > 0 ? third_side / length2 : Vec2(-1, 0);
    const auto f = [](double v) { return static_cast<float>(v); };
    const Vec3 from = a - centre;
    triangle.corner = {f(from.x), f(from.y), f(from.z), f(length0)};
    triangle.normal = {f(n.x), f(n.y), f(n.z), f(d1.x)};
    triangle.along = {f(x.x), f(x.y), f(x.z), f(d1.y)};
    triangle.rest = {f(length1), f(d2.x), f(d2.y), f(length2)};
    signs = {side_word(side0), side_word(side1), side_word(side2), fan_[side0], fan_[side1], fan_[side2], 0, 0};
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> twin_;
  double needle_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> fan_;  // per side: fan of the vertex that it leaves
};

}  // namespace

SurfaceTriangles make_surface_triangles(const Mesh& mesh, std::span<const std::uint32_t> twin,
                                        std::span<const std::uint32_t> order, const Vec3& centre, double needle) {
  return Preparer(mesh, twin, needle).run(order, centre);
}

}  // namespace palpa::geometry
