#include "assets/generators/bunny.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"

namespace palpa::assets {
namespace {

// The rows of three numbers that follow `name`.
std::vector<std::array<double, 3>> read_rows(const std::string& file, const std::string& text,
                                             const std::string& name) {
  const std::size_t at = text.find(name);
  nlohmann::json rows;
  try {
    if (at != std::string::npos) std::istringstream(text.substr(at + name.size())) >> rows;  // reads one value
    if (!rows.empty() &&
        std::all_of(rows.begin(), rows.end(), [](const nlohmann::json& row) { return row.size() == 3; }))
      return rows.get<std::vector<std::array<double, 3>>>();
  } catch (const nlohmann::json::exception&) {
  }
  throw bad_input(file, "has no array " + name + "[[a,b,c],...] of rows of three numbers");
}

// Metres along the ray to the triangle (Moeller and Trumbore), if it meets it from outside.
std::optional<double> hit(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, across = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, across);
  if (determinant <= 0) return std::nullopt;
  const Vec3 from = origin - a, up = glm::cross(from, ab);
  const double u = glm::dot(from, across), v = glm::dot(direction, up), t = glm::dot(ac, up);
  if (u < 0 || v < 0 || u + v > determinant || t < 0) return std::nullopt;
  return t / determinant;
}

}  // namespace

geometry::Mesh read_bunny(const std::filesystem::path& file) {
  const std::string text = read_file(file, 16 << 20);
  geometry::Mesh mesh;
  for (const auto& row : read_rows(file.string(), text, "positions="))
    mesh.positions.emplace_back(row[0], row[1], row[2]);
  for (const auto& row : read_rows(file.string(), text, "cells=")) {
    glm::uvec3 triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(row[i] >= 0 && row[i] < static_cast<double>(mesh.positions.size())) || row[i] != std::floor(row[i]))
        throw bad_input(file.string(), "has a cell that names no position");
      triangle[static_cast<int>(i)] = static_cast<std::uint32_t>(row[i]);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

geometry::Mesh stand_up(geometry::Mesh mesh, double height) {
  const Box box = geometry::bounds(mesh);
  const Vec3 foot((box.low.x + box.high.x) / 2, box.low.y, (box.low.z + box.high.z) / 2);
  for (Vec3& p : mesh.positions)
    p = (p - foot) * (height / (box.high.y - box.low.y));
  return mesh;
}

geometry::Mesh press_finger(const geometry::Mesh& finger, const geometry::Mesh& object, const Vec3& target,
                            const Vec3& direction, double penetration) {
  const Vec3 inwards = glm::normalize(direction);
  const Box box = geometry::bounds(object);
  const Vec3 start = target - inwards * glm::length(box.high - box.low);
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::uvec3& t : object.triangles) {
    const auto distance = hit(start, inwards, object.positions[t[0]], object.positions[t[1]], object.positions[t[2]]);
    if (distance) nearest = std::min(nearest, *distance);
  }
  if (!std::isfinite(nearest)) throw failure("the finger misses the object");
  const Vec3 tip = start + inwards * (nearest + penetration);
  // The finger's own axes in the world: y against the direction, z as near to the world's z as possible.
  const Vec3 y = -inwards;
  const Vec3 towards = std::abs(y.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 x = glm::normalize(glm::cross(y, towards)), z = glm::cross(x, y);
  geometry::Mesh result = finger;
  for (Vec3& p : result.positions)
    p = tip + p.x * x + p.y * y + p.z * z;
  return result;
}

}  // namespace palpa::assets
