#include "acoustics/field/waves.hpp"

#include <cstddef>
#include <glm/geometric.hpp>

namespace palpa::acoustics {

using Complex = std::complex<double>;

Waves plane_wave(double wave_number, const Vec3& direction, std::span<const Vec3> points,
                 std::span<const Vec3> normals) {
  Waves waves;
  for (std::size_t i = 0; i < points.size(); ++i) {
    waves.pressures.push_back(std::polar(1.0, wave_number * glm::dot(direction, points[i])));
    if (!normals.empty())
      waves.slopes.push_back(Complex(0, wave_number * glm::dot(direction, normals[i])) * waves.pressures.back());
  }
  return waves;
}

Waves point_source(double wave_number, const Vec3& source, std::span<const Vec3> points,
                   std::span<const Vec3> normals) {
  Waves waves;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 way = points[i] - source;
    const double r = glm::length(way);
    waves.pressures.push_back(std::polar(1 / r, wave_number * r));
    if (!normals.empty()) {
      const double along = glm::dot(way, normals[i]) / r;
      waves.slopes.push_back(Complex(-1 / r, wave_number) * along * waves.pressures.back());
    }
  }
  return waves;
}

}  // namespace palpa::acoustics
