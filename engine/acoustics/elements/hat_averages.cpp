#include "acoustics/elements/hat_averages.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/geometric.hpp>

#include "acoustics/elements/triangle_rules.hpp"

namespace palpa::acoustics {

HatAverages::HatAverages(const Patches& body) {
  const std::size_t count = body.mesh.positions.size();
  struct Entry {
    std::uint32_t vertex;
    double of;
  };
  std::vector<std::vector<Entry>> rows(count);
  std::vector<double> wholes(count);
  for (std::size_t face = 0; face < body.patches.size(); ++face) {
    const glm::uvec3& t = body.mesh.triangles[face];
    std::array<std::array<double, 3>, 3> products{};
    for (const TriangleSample& q : six_point_rule()) {
      const double area = q.weight * glm::length(body.patches[face].area_vector(q.u, q.v));
      const std::array<double, 3> hat{1 - q.u - q.v, q.u, q.v};
      for (std::size_t i = 0; i < 3; ++i) {
        wholes[t[static_cast<int>(i)]] += area * hat[i];
        for (std::size_t j = 0; j < 3; ++j)
          products[i][j] += area * hat[i] * hat[j];
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<Entry>& row = rows[t[static_cast<int>(i)]];
      for (std::size_t j = 0; j < 3; ++j) {
        const std::uint32_t vertex = t[static_cast<int>(j)];
        const auto found = std::ranges::find(row, vertex, &Entry::vertex);
        if (found == row.end()) {
          row.push_back({vertex, products[i][j]});
        } else {
          found->of += products[i][j];
        }
      }
    }
  }
  first_.push_back(0);
  for (std::size_t v = 0; v < count; ++v) {
    for (const Entry& entry : rows[v])
      weights_.push_back({entry.vertex, static_cast<float>(entry.of / wholes[v])});
    first_.push_back(static_cast<std::uint32_t>(weights_.size()));
  }
}

std::vector<std::complex<double>> HatAverages::of(std::span<const std::complex<float>> values) const {
  std::vector<std::complex<double>> averages(values.size());
  for (std::uint32_t v = 0; v < averages.size(); ++v)
    averages[v] = at(v, values);
  return averages;
}

std::complex<double> HatAverages::at(std::uint32_t vertex, std::span<const std::complex<float>> values) const {
  std::complex<double> sum = 0;
  for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i)
    sum += static_cast<double>(weights_[i].of) * std::complex<double>(values[weights_[i].vertex]);
  return sum;
}

void HatAverages::add_row(std::uint32_t vertex, double factor, std::span<std::complex<float>> row) const {
  for (std::uint32_t at = first_[vertex]; at < first_[vertex + 1]; ++at)
    row[weights_[at].vertex] += static_cast<float>(factor * static_cast<double>(weights_[at].of));
}

}  // namespace palpa::acoustics
