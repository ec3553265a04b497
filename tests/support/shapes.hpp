// Meshes of known volume for tests.
#pragma once

#include <functional>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::test {

/// 12 triangles facing outwards, 8 shared vertices.
geometry::Mesh box(const Vec3& low, const Vec3& high);

/// An outline in x and y, from `low` to `high` in z. The triangles divide it. Both run counterclockwise.
geometry::Mesh prism(const std::vector<Vec2>& outline, const std::vector<glm::uvec3>& triangles, double low,
                     double high);

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

/// A box of these half sides, with its triangles divided.
geometry::Mesh divided_box(const Vec3& half, int times);

/// A cube about the origin; each side is divided into squares of two triangles.
geometry::Mesh squared_cube(double side, int squares);

geometry::Mesh transformed(geometry::Mesh mesh, const std::function<Vec3(const Vec3&)>& map);

/// Coordinates rounded to single precision, as a file stores them.
geometry::Mesh rounded(const geometry::Mesh& mesh);

}  // namespace palpa::test
