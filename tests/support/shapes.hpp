// Meshes of known volume for tests.
#pragma once

#include <functional>

#include "geometry/mesh/mesh.hpp"

namespace palpa::test {

/// 12 triangles facing outwards, 8 shared vertices.
geometry::Mesh box(const Vec3& low, const Vec3& high);

/// An L along x, 60 mm long, 40 mm high and deep, without the upper half of its right half. Its top is at y = 0.
geometry::Mesh ell();

/// With rings x segments around the z axis; closed, facing outwards.
geometry::Mesh sphere(double radius, int rings, int segments);

/// A ring around the z axis.
geometry::Mesh torus(double radius, double tube, int segments);

/// The mesh with three separate vertices for every triangle.
geometry::Mesh unshared(const geometry::Mesh& mesh);

/// The mesh with each triangle divided into four, `times` times, with shared vertices.
geometry::Mesh divided(const geometry::Mesh& mesh, int times);

geometry::Mesh transformed(geometry::Mesh mesh, const std::function<Vec3(const Vec3&)>& map);

/// Coordinates rounded to single precision, as a file stores them.
geometry::Mesh rounded(const geometry::Mesh& mesh);

}  // namespace palpa::test
