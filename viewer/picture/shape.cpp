#include "viewer/picture/shape.hpp"

#include <meshoptimizer.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "geometry/mesh/topology.hpp"
#include "viewer/picture/view_vertex.hpp"
#include "viewer/view/frustum.hpp"

namespace palpa::viewer {
namespace {

struct Edge {
  std::uint32_t low, high;    // its vertices
  std::uint32_t left, right;  // faces
  bool open, sharp;
};

// A scanned surface is full of small folds, which would look like scratches as lines. Creases that end somewhere, and
// that are shorter than a quarter of the object together with all that they meet, are not drawn.
void drop_scratches(const geometry::Mesh& mesh, std::vector<Edge>& edges) {
  geometry::UnionFind lines(mesh.positions.size());
  std::vector<std::uint32_t> ends(mesh.positions.size(), 0);
  for (const Edge& e : edges) {
    if (!e.sharp) continue;
    lines.join(e.low, e.high);
    ++ends[e.low];
    ++ends[e.high];
  }
  std::vector<double> length(mesh.positions.size(), 0);
  std::vector<char> stops(mesh.positions.size(), 0);
  for (const Edge& e : edges) {
    if (!e.sharp) continue;
    const std::uint32_t line = lines.find(e.low);
    length[line] += glm::length(mesh.positions[e.high] - mesh.positions[e.low]);
    if (e.open || ends[e.low] == 1 || ends[e.high] == 1) stops[line] = e.open ? 2 : std::max<char>(stops[line], 1);
  }
  const Box box = geometry::bounds(mesh);
  const double least = glm::length(box.high - box.low) / 4;
  for (Edge& e : edges) {
    const std::uint32_t line = lines.find(e.low);
    if (e.sharp && stops[line] == 1 && length[line] < least) e.sharp = false;
  }
}

// Faces around each vertex, as offsets into one list.
struct Fans {
  std::vector<std::uint32_t> first, around;
};

Fans fans_of(std::size_t vertices, const std::vector<glm::uvec3>& faces) {
  Fans fans{std::vector<std::uint32_t>(vertices + 1, 0), std::vector<std::uint32_t>(faces.size() * 3)};
  for (const auto& t : faces) {
    for (int k = 0; k < 3; ++k)
      ++fans.first[t[k] + 1];
  }
  std::partial_sum(fans.first.begin(), fans.first.end(), fans.first.begin());
  auto next = fans.first;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k)
      fans.around[next[faces[f][k]]++] = f;
  }
  return fans;
}

bool same_normal(const shader::ViewVertex& a, const shader::ViewVertex& b) {
  return a.normal.x == b.normal.x && a.normal.y == b.normal.y && a.normal.z == b.normal.z;
}

// Returns the vertex at a place with a given normal, and makes it if there is none yet.
class VertexPool {
 public:
  VertexPool(std::size_t places, std::vector<shader::ViewVertex>& vertices)
      : vertices_(&vertices), newest_(places, none) {}
  std::uint32_t find(std::uint32_t place, const shader::ViewVertex& wanted) {
    for (std::uint32_t i = newest_[place]; i != none; i = before_[i]) {
      if (same_normal((*vertices_)[i], wanted)) return i;
    }
    before_.push_back(newest_[place]);
    newest_[place] = static_cast<std::uint32_t>(vertices_->size());
    vertices_->push_back(wanted);
    return newest_[place];
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  std::vector<shader::ViewVertex>* vertices_;
  std::vector<std::uint32_t> newest_, before_;
};

// A device shades a vertex again after a few others, so triangles that share vertices follow each other.
void order(Shape& shape) {
  if (shape.corners.empty()) return;
  meshopt_optimizeVertexCache(shape.corners.data(), shape.corners.data(), shape.corners.size(), shape.vertices.size());
  meshopt_optimizeVertexFetch(shape.vertices.data(), shape.corners.data(), shape.corners.size(), shape.vertices.data(),
                              shape.vertices.size(), sizeof(shader::ViewVertex));
}

EdgeNet net_of(const geometry::Mesh& mesh, const std::vector<glm::uvec3>& faces, const std::vector<Vec3>& normals,
               const std::vector<Edge>& edges) {
  EdgeNet net;
  std::vector<std::uint32_t> place(mesh.positions.size(), 0);
  for (const Edge& e : edges) {
    if (e.sharp) {
      net.creases.push_back({vec4_of(mesh.positions[e.low], 0), vec4_of(mesh.positions[e.high], 0)});
      continue;
    }
    for (const std::uint32_t v : {e.low, e.high}) {
      if (place[v] != 0) continue;
      net.ends.push_back(vec4_of(mesh.positions[v], 0));
      place[v] = static_cast<std::uint32_t>(net.ends.size());
    }
    net.folds.push_back({place[e.low] - 1, place[e.high] - 1, e.left, e.right});
  }
  if (net.folds.empty()) return net;
  net.planes.reserve(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    net.planes.push_back(vec4_of(normals[f], glm::dot(normals[f], mesh.positions[faces[f].x])));
  return net;
}

}  // namespace

Shape make_shape(const geometry::Mesh& mesh, std::span<const drawing::Colour> colours) {
  Shape shape;
  const double smooth = std::cos(0.52);
  std::vector<glm::uvec3> faces;
  std::vector<Vec3> area_normals;  // length: twice the area
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const Vec3 n = glm::cross(b - a, c - a);
    if (!(glm::length(n) > 0)) continue;
    faces.push_back(t);
    area_normals.push_back(n);
  }

  const Fans fans = fans_of(mesh.positions.size(), faces);
  std::vector<Vec3> normals(faces.size());
  std::transform(area_normals.begin(), area_normals.end(), normals.begin(),
                 [](const Vec3& n) { return glm::normalize(n); });
  VertexPool pool(mesh.positions.size(), shape.vertices);
  shape.corners.reserve(faces.size() * 3);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = faces[f][k];
      Vec3 sum(0);
      for (std::uint32_t i = fans.first[v]; i < fans.first[v + 1]; ++i) {
        const std::uint32_t beside = fans.around[i];
        if (glm::dot(normals[beside], normals[f]) > smooth) sum += area_normals[beside];
      }
      const glm::vec3 at(mesh.positions[v]), normal(glm::normalize(sum));
      shape.corners.push_back(pool.find(v, colours.empty() ? plain(at, normal) : coloured(at, normal, colours[v])));
    }
  }
  order(shape);

  std::vector<Edge> edges;
  geometry::for_each_edge(mesh.positions.size(), faces, [&](std::span<const geometry::Side> sides) {
    const std::uint32_t left = sides.front().side / 3, right = sides.back().side / 3;
    const double bend = glm::dot(normals[left], normals[right]);
    const bool open = sides.size() != 2;
    if (open || bend < 1 - 1e-9)
      edges.push_back({sides[0].low, sides[0].high, left, right, open, open || bend <= smooth});
  });
  drop_scratches(mesh, edges);
  shape.edges = net_of(mesh, faces, normals, edges);
  return shape;
}

}  // namespace palpa::viewer
