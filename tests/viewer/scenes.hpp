// Small scenes whose pictures can be foretold.
#pragma once

#include "geometry/mesh.hpp"
#include "viewer/picture.hpp"
#include "viewer/viewpoint.hpp"

namespace palpa::test {

/// Axis-aligned, facing outwards.
inline geometry::Mesh box_mesh(const Vec3& low, const Vec3& high) {
  geometry::Mesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  }
  const auto quad = [&](unsigned a, unsigned b, unsigned c, unsigned d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  quad(4, 5, 7, 6);
  quad(1, 0, 2, 3);
  quad(5, 1, 3, 7);
  quad(0, 4, 6, 2);
  quad(6, 7, 3, 2);
  quad(0, 1, 5, 4);
  return mesh;
}

/// A picture with nothing but background.
inline viewer::Picture bare() {
  viewer::Picture picture;
  picture.legend = false;
  picture.grid = false;
  return picture;
}

inline viewer::Picture cube_picture() {
  viewer::Picture picture = bare();
  picture.solids.push_back({"cube", box_mesh({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02})});
  return picture;
}

/// From the front, 0.2 m before the origin.
inline viewer::Viewpoint front_viewpoint() {
  viewer::Viewpoint viewpoint;
  viewpoint.azimuth = 0;
  viewpoint.elevation = 0;
  viewpoint.distance = 0.2;
  return viewpoint;
}

}  // namespace palpa::test
