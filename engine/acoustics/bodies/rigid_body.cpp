#include "acoustics/bodies/rigid_body.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <utility>

#include "acoustics/compressed/body_operator.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {

using Complex = std::complex<double>;

namespace {

constexpr std::size_t samples = 3;

bool all_finite(std::span<const std::complex<float>> numbers) {
  return std::ranges::all_of(numbers, [](const std::complex<float>& number) {
    return std::isfinite(number.real()) && std::isfinite(number.imag());
  });
}

}  // namespace

RigidBody::RigidBody(geometry::Mesh mesh, double wave_number, const std::atomic<bool>* give_up)
    : patches_(make_patches(std::move(mesh))),
      wave_number_(wave_number),
      fit_(patches_),
      operator_(make_operator(patches_, wave_number, give_up)) {
  for (const Patch& patch : patches_.patches) {
    for (const TriangleSample& s : three_point_rule()) {
      const Vec3 area = patch.area_vector(s.u, s.v);
      const double length = glm::length(area);
      points_.push_back(patch.at(s.u, s.v));
      normals_.push_back(area / length);
      areas_.push_back(s.weight * length);
    }
  }
  vertex_normals_.assign(this->mesh().positions.size(), Vec3(0));
  for (std::size_t point = 0; point < points_.size(); ++point) {
    const glm::uvec3& corners = this->mesh().triangles[point / samples];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = corners[static_cast<int>(c)];
      vertex_normals_[vertex] += hat_at_sample(c, point % samples) * areas_[point] * normals_[point];
    }
  }
  for (Vec3& normal : vertex_normals_)
    normal = glm::normalize(normal);
}

RigidBody::Effort RigidBody::effort() const {
  const std::lock_guard lock(effort_->mutex);
  return {operator_->iterates(), effort_->worst};
}

void RigidBody::find_unknowns(Way way, std::span<std::complex<float>> columns, const std::atomic<bool>* give_up) const {
  const SolveReport report = operator_->solve(way, columns, give_up);
  const std::lock_guard lock(effort_->mutex);
  effort_->worst.iterations = std::max(effort_->worst.iterations, report.iterations);
  effort_->worst.residual = std::max(effort_->worst.residual, report.residual);
}

std::vector<std::complex<float>> RigidBody::solve(const Waves& incident, const std::atomic<bool>* give_up) const {
  assert(incident.slopes.size() == incident.pressures.size());
  const std::size_t size = mesh().positions.size(), count = incident.pressures.size() / points_.size();
  std::vector<std::complex<float>> columns(count * size);
  parallel_chunks(count, 1, [&](std::size_t wave, std::size_t, std::size_t) {
    std::vector<Complex> sums(size);
    for (std::size_t point = 0; point < points_.size(); ++point) {
      const std::size_t at = wave * points_.size() + point;
      const Complex value = areas_[point] * (incident.pressures[at] + slope_part() * incident.slopes[at]);
      const glm::uvec3& corners = mesh().triangles[point / samples];
      for (std::size_t c = 0; c < 3; ++c)
        sums[corners[static_cast<int>(c)]] += hat_at_sample(c, point % samples) * value;
    }
    for (std::size_t v = 0; v < size; ++v)
      columns[wave * size + v] = std::complex<float>(sums[v]);
  });
  if (!all_finite(columns)) throw failure("The incident wave on the surface is too large, or is not a number");
  find_unknowns(Way::forth, columns, give_up);
  if (!all_finite(columns))
    throw failure("The pressure on the surface is not a number; a mesh with more even faces may help");
  return columns;
}

void RigidBody::respond(std::span<std::complex<float>> right_sides, const std::atomic<bool>* give_up) const {
  find_unknowns(Way::forth, right_sides, give_up);
}

std::vector<FaceSound> RigidBody::at_faces(std::span<const std::complex<float>> unknowns) const {
  return fit_.at_faces(unknowns);
}

SkinSound RigidBody::on_skin(std::span<const std::complex<float>> unknowns) const {
  return fit_.on(patches_, unknowns);
}

std::vector<Complex> RigidBody::at_vertices(std::span<const std::complex<float>> unknowns) const {
  return fit_.at_vertices(unknowns);
}

FaceSound RigidBody::at_skin(std::span<const std::complex<float>> unknowns, std::uint32_t face, double u,
                             double v) const {
  const Patch& patch = patches_.patches[face];
  return fit_.at(face, patch.at(u, v), glm::normalize(patch.area_vector(u, v)), unknowns);
}

RigidBody::Row RigidBody::row_on_skin(std::uint32_t face, double u, double v) const {
  Row row(mesh().positions.size());
  fit_.add_pressure_row(face, patches_.patches[face].at(u, v), row);
  return row;
}

std::vector<Complex> RigidBody::sources_of(std::span<const Row> rows) const {
  const std::size_t size = mesh().positions.size(), count = points_.size();
  std::vector<std::complex<float>> columns;
  columns.reserve(rows.size() * size);
  for (const Row& row : rows)
    columns.insert(columns.end(), row.begin(), row.end());
  find_unknowns(Way::back, columns, nullptr);
  std::vector<Complex> sources(rows.size() * count);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t point = 0; point < count; ++point) {
      const glm::uvec3& corners = mesh().triangles[point / samples];
      Complex sum = 0;
      for (std::size_t c = 0; c < 3; ++c)
        sum += hat_at_sample(c, point % samples) * Complex(columns[i * size + corners[static_cast<int>(c)]]);
      sources[i * count + point] = areas_[point] * sum;
    }
  }
  return sources;
}

}  // namespace palpa::acoustics
