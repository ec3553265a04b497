// Facets grow from their widest triangle over its neighbours. One triangle determines its plane only to a coordinate's
// error divided by its width, which is too inaccurate to reach across a finely divided face. The plane is therefore
// fitted again as the facet grows. On a curved surface, growth ends where the surface has sunk by about two tolerances.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "geometry/mesh/topology.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {
namespace {

class Grower {
 public:
  Grower(const Mesh& mesh, std::span<const std::uint32_t> twin, double tolerance)
      : mesh_(mesh), twin_(twin), tolerance_(tolerance) {
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    area_vectors_.reserve(count);
    width_.reserve(count);
    for (std::uint32_t t = 0; t < count; ++t) {
      area_vectors_.push_back(area_vector(mesh, t));
      width_.push_back(triangle_width(mesh, t, glm::length(area_vectors_[t])));
    }
    facet_of_.assign(count, Facets::no_facet);
  }

  Facets run() {
    std::vector<std::uint32_t> order(width_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return width_[a] != width_[b] ? width_[a] > width_[b] : a < b; });
    for (const std::uint32_t seed : order) {
      if (!(width_[seed] > tolerance_)) break;  // only slivers are left
      if (facet_of_[seed] == Facets::no_facet) grow(seed);
    }
    return in_order_of_first_triangle();
  }

 private:
  struct Grown {
    std::uint32_t first;
    Plane plane;
    Vec3 centre;
    double width;
  };

  void grow(std::uint32_t seed) {
    member_.clear();
    rejected_.clear();
    total_ = moment_ = Vec3(0);
    weight_ = 0;
    normal_ = glm::normalize(area_vectors_[seed]);
    offset_ = glm::dot(normal_, mesh_.positions[mesh_.triangles[seed][0]]);
    join(seed);
    std::size_t done = 0, fitted = 1;
    for (;;) {
      for (; done < member_.size(); ++done) {
        for (std::uint32_t side = 3 * member_[done]; side < 3 * member_[done] + 3; ++side)
          try_neighbour(side);
      }
      // A new fit is only worth it when the facet has grown by a quarter, so there are few.
      if (member_.size() < fitted + fitted / 4 + 1) break;
      fitted = member_.size();
      normal_ = glm::normalize(total_);
      offset_ = glm::dot(normal_, moment_ / weight_);
      std::vector<std::uint32_t> again;
      again.swap(rejected_);
      for (const std::uint32_t side : again)
        try_neighbour(side);
    }
    finish(seed);
  }

  void join(std::uint32_t triangle) {
    facet_of_[triangle] = static_cast<std::uint32_t>(grown_.size());
    member_.push_back(triangle);
    const glm::uvec3& c = mesh_.triangles[triangle];
    const double twice_area = glm::length(area_vectors_[triangle]);
    total_ += area_vectors_[triangle];
    moment_ += twice_area / 3 * (mesh_.positions[c[0]] + mesh_.positions[c[1]] + mesh_.positions[c[2]]);
    weight_ += twice_area;
  }

  void try_neighbour(std::uint32_t side) {
    const std::uint32_t neighbour = twin_[side] / 3;
    if (facet_of_[neighbour] != Facets::no_facet) return;
    const double above = glm::dot(normal_, mesh_.positions[opposite_vertex(mesh_, twin_[side])]) - offset_;
    // A triangle folded back onto the facet also lies in its plane, but faces the other way.
    const bool folded = width_[neighbour] > tolerance_ && glm::dot(area_vectors_[neighbour], normal_) < 0;
    if (std::abs(above) > tolerance_ || folded) {
      rejected_.push_back(side);
    } else {
      join(neighbour);
    }
  }

  void finish(std::uint32_t seed) {
    Plane plane{glm::normalize(total_), -std::numeric_limits<double>::infinity()};
    Box box;
    std::uint32_t first = seed;
    for (const std::uint32_t t : member_) {
      first = std::min(first, t);
      for (int i = 0; i < 3; ++i) {
        // No corner of the facet lies outside its plane.
        const Vec3& corner = mesh_.positions[mesh_.triangles[t][i]];
        plane.offset = std::max(plane.offset, glm::dot(plane.normal, corner));
        box.add(corner);
      }
    }
    const double across = weight_ / 2 / glm::distance(box.low, box.high);
    grown_.push_back({first, plane, moment_ / weight_, std::max(width_[seed], across)});
  }

  Facets in_order_of_first_triangle() {
    std::vector<std::uint32_t> by_first(grown_.size()), place(grown_.size());
    std::iota(by_first.begin(), by_first.end(), 0U);
    std::sort(by_first.begin(), by_first.end(),
              [&](std::uint32_t a, std::uint32_t b) { return grown_[a].first < grown_[b].first; });
    Facets facets;
    for (std::uint32_t i = 0; i < by_first.size(); ++i) {
      const Grown& g = grown_[by_first[i]];
      place[by_first[i]] = i;
      facets.planes.push_back(g.plane);
      facets.centres.push_back(g.centre);
      facets.widths.push_back(g.width);
    }
    facets.of_triangle = std::move(facet_of_);
    for (std::uint32_t& facet : facets.of_triangle) {
      if (facet != Facets::no_facet) facet = place[facet];
    }
    return facets;
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> twin_;
  double tolerance_;
  std::vector<Vec3> area_vectors_;
  std::vector<double> width_;
  std::vector<std::uint32_t> facet_of_;
  std::vector<Grown> grown_;
  // The growing facet.
  std::vector<std::uint32_t> member_, rejected_;
  Vec3 total_{0}, moment_{0}, normal_{0};
  double weight_ = 0, offset_ = 0;
};

}  // namespace

Facets find_facets(const Mesh& mesh, std::span<const std::uint32_t> twin, double tolerance) {
  return Grower(mesh, twin, tolerance).run();
}

}  // namespace palpa::geometry
