#include "assets/generators/bunny.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/input_file.hpp"

namespace palpa::assets {
namespace {

// The rows of three numbers that follow `name`.
std::vector<std::array<double, 3>> read_rows(const std::string& file, std::string_view text, std::string_view name) {
  const auto fail = [&] {
    return bad_input(file, std::string("has no array ") + std::string(name) + "[[a,b,c],...] of rows of three numbers");
  };
  std::size_t at = text.find(name);
  if (at == std::string_view::npos) throw fail();
  at += name.size();
  const auto skip_space = [&] { at = std::min(text.find_first_not_of(" \t\r\n", at), text.size()); };
  const auto take = [&](char c) {
    skip_space();
    if (at < text.size() && text[at] == c) {
      ++at;
      return true;
    }
    return false;
  };
  std::vector<std::array<double, 3>> rows;
  if (!take('[')) throw fail();
  do {
    std::array<double, 3> row{};
    if (!take('[')) throw fail();
    for (std::size_t i = 0; i < 3; ++i) {
      if (i > 0 && !take(',')) throw fail();
      skip_space();
      const auto [rest, fault] = std::from_chars(text.data() + at, text.data() + text.size(), row[i]);
      if (fault != std::errc{}) throw fail();
      at = static_cast<std::size_t>(rest - text.data());
    }
    if (!take(']')) throw fail();
    rows.push_back(row);
  } while (take(','));
  if (!take(']')) throw fail();
  return rows;
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
