// Meshes of known volume for tests, and help to say what an error must be.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "base/error.hpp"
#include "geometry/mesh.hpp"

namespace palpa::test {

/// 12 triangles facing outwards, 8 shared vertices.
geometry::Mesh box(const Vec3& low, const Vec3& high);

/// An L along x, 60 mm long, 40 mm high and deep, without the upper half of its right half; its top at y = 0.
geometry::Mesh ell();

/// rings x segments around the z axis, closed, facing outwards.
geometry::Mesh sphere(double radius, int rings, int segments);

/// A ring around the z axis.
geometry::Mesh torus(double radius, double tube, int segments);

/// Every triangle with three vertices of its own.
geometry::Mesh unshared(const geometry::Mesh& mesh);

geometry::Mesh transformed(geometry::Mesh mesh, const std::function<Vec3(const Vec3&)>& map);

/// Coordinates rounded to single precision, as a file stores them.
geometry::Mesh rounded(const geometry::Mesh& mesh);

/// The error's line; an empty string when `action` throws none. Fails the test on errors with another exit code or more
/// than one line.
std::string error_of(const std::function<void()>& action, Exit code = Exit::bad_input);

/// What is written to stderr meanwhile.
std::string stderr_of(const std::function<void()>& action);

}  // namespace palpa::test

#define EXPECT_CONTAINS(text, part) \
  EXPECT_NE(std::string(text).find(part), std::string::npos) << "\"" << (text) << "\" lacks \"" << (part) << "\""
