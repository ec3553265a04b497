// Averages of a function on the surface, weighted by the hat function of each vertex:
//
//   m_v = integral of f_v p / integral of f_v
//
// The hat functions are the test functions of Galerkin's method (galerkin.hpp), so these averages of its solution are
// far more accurate than its values at points.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

class HatAverages {
 public:
  explicit HatAverages(const Patches& body);

  /// The averages of a function that is linear on the patches, from its values at the vertices. One entry per vertex.
  std::vector<std::complex<double>> of(std::span<const std::complex<float>> values) const;

  /// The average at one vertex.
  std::complex<double> at(std::uint32_t vertex, std::span<const std::complex<float>> values) const;

  /// Adds `factor` times the weights that give the average at a vertex from the values at all vertices.
  void add_row(std::uint32_t vertex, double factor, std::span<std::complex<float>> row) const;

 private:
  struct Weight {
    std::uint32_t vertex;
    float of;
  };
  std::vector<std::uint32_t> first_;  // by vertex: the first of its weights
  std::vector<Weight> weights_;
};

}  // namespace palpa::acoustics
