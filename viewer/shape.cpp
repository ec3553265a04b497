#include "viewer/shape.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

#include "geometry/topology.hpp"
#include "viewer/view_vertex.hpp"

namespace palpa::viewer {
namespace {

shader::vec4 pack(const Vec3& v, double w = 0) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

struct Side {
  std::uint32_t low, high;  // the edge's vertices
  std::uint32_t face;
};

struct Edge {
  std::uint32_t low, high;
  const Vec3 *left, *right;  // normals of the faces
  bool open, sharp;
};

// A scanned surface is full of small folds, which as lines would be scratches: creases that end somewhere and are, with
// all that they meet, shorter than a quarter of the object are not drawn as creases.
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

}  // namespace

Shape make_shape(const geometry::Mesh& mesh, double crease, std::span<const drawing::Colour> colours) {
  Shape shape;
  const double smooth = std::cos(crease);
  std::vector<glm::uvec3> faces;
  std::vector<Vec3> area_normals;  // length: twice the area
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const Vec3 n = glm::cross(b - a, c - a);
    if (!(glm::length(n) > 0)) continue;
    faces.push_back(t);
    area_normals.push_back(n);
  }

  // Faces around each vertex, as offsets into one list.
  std::vector<std::uint32_t> first(mesh.positions.size() + 1, 0), around(faces.size() * 3);
  for (const auto& t : faces) {
    for (int k = 0; k < 3; ++k)
      ++first[t[k] + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  auto next = first;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k)
      around[next[faces[f][k]]++] = f;
  }

  std::vector<Vec3> normals(faces.size());
  std::transform(area_normals.begin(), area_normals.end(), normals.begin(),
                 [](const Vec3& n) { return glm::normalize(n); });
  shape.vertices.reserve(faces.size() * 3);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = faces[f][k];
      Vec3 sum(0);
      for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) {
        if (glm::dot(normals[around[i]], normals[f]) > smooth) sum += area_normals[around[i]];
      }
      const glm::vec3 at(mesh.positions[v]), normal(glm::normalize(sum));
      shape.vertices.push_back(colours.empty() ? plain(at, normal) : coloured(at, normal, colours[v]));
    }
  }

  std::vector<Side> sides;
  sides.reserve(faces.size() * 3);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces[f][k], faces[f][(k + 1) % 3]);
      sides.push_back({low, high, f});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    const Vec3& left = normals[sides[i].face];
    const Vec3& right = normals[sides[end - 1].face];
    const bool open = end - i != 2;
    if (open || glm::dot(left, right) < 1 - 1e-9)
      edges.push_back({sides[i].low, sides[i].high, &left, &right, open, open || glm::dot(left, right) <= smooth});
    i = end;
  }
  drop_scratches(mesh, edges);
  shape.edges.reserve(edges.size());
  for (const Edge& e : edges) {
    shape.edges.push_back(
        {pack(mesh.positions[e.low], e.sharp ? 1 : 0), pack(mesh.positions[e.high]), pack(*e.left), pack(*e.right)});
  }
  return shape;
}

}  // namespace palpa::viewer
