#include "acoustics/boundary/surface_sound.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "acoustics/boundary/triangle_rules.hpp"
#include "base/parallel.hpp"

namespace palpa::acoustics {
namespace {

constexpr std::size_t terms = 6;
using Terms = std::array<double, terms>;

Terms terms_at(double s, double t) {
  return {1, s, t, s * s, s * t, t * t};
}

std::uint32_t next(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

/// The faces that share a corner with `face` without a sharp edge in between, including itself; ascending.
std::vector<std::uint32_t> faces_around(const Patches& body, std::uint32_t face) {
  std::vector<std::uint32_t> found{face};
  for (std::uint32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
    // In both directions around the corner's vertex, until a sharp edge or the start.
    for (std::uint32_t at = corner; !body.sharp[at];) {
      at = next(body.twin[at]);
      if (at == corner) break;
      found.push_back(at / 3);
    }
    for (std::uint32_t at = corner; !body.sharp[next(next(at))];) {
      at = body.twin[next(next(at))];
      if (at == corner) break;
      found.push_back(at / 3);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Solves the symmetric positive-definite system `matrix` x = right in place (Cholesky), for several right-hand sides.
void solve(std::array<Terms, terms>& matrix, std::vector<Terms>& rights) {
  for (std::size_t i = 0; i < terms; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix[i][j];
      for (std::size_t l = 0; l < j; ++l)
        sum -= matrix[i][l] * matrix[j][l];
      matrix[i][j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / matrix[j][j];
    }
  }
  for (Terms& x : rights) {
    for (std::size_t i = 0; i < terms; ++i) {
      for (std::size_t l = 0; l < i; ++l)
        x[i] -= matrix[i][l] * x[l];
      x[i] /= matrix[i][i];
    }
    for (std::size_t i = terms; i-- > 0;) {
      for (std::size_t l = i + 1; l < terms; ++l)
        x[i] -= matrix[l][i] * x[l];
      x[i] /= matrix[i][i];
    }
  }
}

}  // namespace

SurfaceFit::SurfaceFit(const Patches& body) : positions_(body.mesh.positions) {
  const std::size_t count = body.patches.size();
  frames_.resize(count);
  std::vector<std::vector<Share>> shares(count);
  parallel_chunks(count, 64, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) {
      const Patch& own = body.patches[face];
      const Vec3 area = own.area_vector(1.0 / 3, 1.0 / 3);
      const double scale = std::sqrt(glm::length(area));
      const Vec3 normal = glm::normalize(area);
      const Vec3 s = glm::normalize(own.along_u(1.0 / 3, 1.0 / 3));
      Frame& frame = frames_[face];
      frame = {own.at(1.0 / 3, 1.0 / 3), s * scale, glm::cross(normal, s) * scale};
      std::array<Terms, terms> matrix{};
      std::vector<std::uint32_t> vertices;
      std::vector<Terms> rights;
      for (const std::uint32_t other : faces_around(body, static_cast<std::uint32_t>(face))) {
        const Patch& patch = body.patches[other];
        std::array<std::size_t, 3> place;
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t vertex = body.mesh.triangles[other][static_cast<int>(i)];
          place[i] = static_cast<std::size_t>(std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin());
          if (place[i] == vertices.size()) {
            vertices.push_back(vertex);
            rights.push_back({});
          }
        }
        for (const TriangleSample& q : six_point_rule()) {
          const Vec3 from = (patch.at(q.u, q.v) - frame.origin) / (scale * scale);
          const Terms at = terms_at(glm::dot(from, frame.s), glm::dot(from, frame.t));
          const double weight = q.weight * glm::length(patch.area_vector(q.u, q.v)) / (scale * scale);
          const std::array<double, 3> hat{1 - q.u - q.v, q.u, q.v};
          for (std::size_t i = 0; i < terms; ++i) {
            for (std::size_t j = 0; j < terms; ++j)
              matrix[i][j] += weight * at[i] * at[j];
            for (std::size_t c = 0; c < 3; ++c)
              rights[place[c]][i] += weight * at[i] * hat[c];
          }
        }
      }
      solve(matrix, rights);
      for (std::size_t v = 0; v < vertices.size(); ++v) {
        Share share{vertices[v], {}};
        for (std::size_t i = 0; i < terms; ++i)
          share.of[i] = static_cast<float>(rights[v][i]);
        shares[face].push_back(share);
      }
    }
  });
  first_.push_back(0);
  for (std::size_t face = 0; face < count; ++face) {
    shares_.insert(shares_.end(), shares[face].begin(), shares[face].end());
    first_.push_back(static_cast<std::uint32_t>(shares_.size()));
    const glm::uvec3& t = body.mesh.triangles[face];
    corners_.push_back({t.x, t.y, t.z});
  }
}

std::array<std::complex<double>, 6> SurfaceFit::quadratic(std::size_t face,
                                                          std::span<const std::complex<float>> solution) const {
  std::array<std::complex<double>, terms> sum{};
  for (std::uint32_t at = first_[face]; at < first_[face + 1]; ++at) {
    const std::complex<double> value = solution[shares_[at].vertex];
    for (std::size_t i = 0; i < terms; ++i)
      sum[i] += static_cast<double>(shares_[at].of[i]) * value;
  }
  return sum;
}

std::vector<FaceSound> SurfaceFit::at_faces(std::span<const std::complex<float>> solution) const {
  std::vector<FaceSound> sounds(frames_.size());
  parallel_chunks(sounds.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face)
      sounds[face] = at(face, frames_[face].origin, solution);
  });
  return sounds;
}

void SurfaceFit::add_pressure_row(std::uint32_t face, std::span<std::complex<float>> row) const {
  for (std::uint32_t at = first_[face]; at < first_[face + 1]; ++at)
    row[shares_[at].vertex] += shares_[at].of[0];
}

FaceSound SurfaceFit::at(std::size_t face, const Vec3& point, std::span<const std::complex<float>> solution) const {
  const auto sum = quadratic(face, solution);
  const Frame& frame = frames_[face];
  const double scale2 = glm::dot(frame.s, frame.s);
  const Vec3 from = (point - frame.origin) / scale2;
  const double s = glm::dot(from, frame.s), t = glm::dot(from, frame.t);
  const Terms at = terms_at(s, t);
  FaceSound sound{};
  for (std::size_t i = 0; i < terms; ++i)
    sound.pressure += sum[i] * at[i];
  const std::complex<double> along_s = sum[1] + 2 * s * sum[3] + t * sum[4];
  const std::complex<double> along_t = sum[2] + s * sum[4] + 2 * t * sum[5];
  for (int axis = 0; axis < 3; ++axis)
    sound.gradient[static_cast<std::size_t>(axis)] = (along_s * frame.s[axis] + along_t * frame.t[axis]) / scale2;
  return sound;
}

void SurfaceFit::add_pressure_row(std::uint32_t face, const Vec3& at, std::span<std::complex<float>> row) const {
  const Frame& frame = frames_[face];
  const Vec3 from = (at - frame.origin) / glm::dot(frame.s, frame.s);
  const Terms by = terms_at(glm::dot(from, frame.s), glm::dot(from, frame.t));
  for (std::uint32_t share = first_[face]; share < first_[face + 1]; ++share) {
    double sum = 0;
    for (std::size_t i = 0; i < terms; ++i)
      sum += by[i] * static_cast<double>(shares_[share].of[i]);
    row[shares_[share].vertex] += static_cast<float>(sum);
  }
}

std::vector<std::complex<double>> SurfaceFit::at_vertices(std::span<const std::complex<float>> solution) const {
  std::vector<std::complex<double>> sums(positions_.size());
  std::vector<double> faces(positions_.size());
  for (std::size_t face = 0; face < frames_.size(); ++face) {
    for (const std::uint32_t vertex : corners_[face]) {
      sums[vertex] += at(face, positions_[vertex], solution).pressure;
      ++faces[vertex];
    }
  }
  for (std::size_t vertex = 0; vertex < sums.size(); ++vertex)
    sums[vertex] /= faces[vertex];
  return sums;
}

}  // namespace palpa::acoustics
