#include "array/solvers/complex_system.hpp"

#include <cstddef>
#include <utility>

namespace palpa::array {

using Complex = std::complex<double>;

void solve_complex(std::span<Complex> system, std::span<Complex> rest) {
  const std::size_t rows = rest.size();
  for (std::size_t k = 0; k < rows; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < rows; ++i) {
      if (std::norm(system[i * rows + k]) > std::norm(system[pivot * rows + k])) pivot = i;
    }
    for (std::size_t j = 0; j < rows && pivot != k; ++j)
      std::swap(system[k * rows + j], system[pivot * rows + j]);
    std::swap(rest[k], rest[pivot]);
    if (std::norm(system[k * rows + k]) == 0) continue;
    for (std::size_t i = k + 1; i < rows; ++i) {
      const Complex part = system[i * rows + k] / system[k * rows + k];
      for (std::size_t j = k; j < rows; ++j)
        system[i * rows + j] -= part * system[k * rows + j];
      rest[i] -= part * rest[k];
    }
  }
  for (std::size_t k = rows; k-- > 0;) {
    for (std::size_t j = k + 1; j < rows; ++j)
      rest[k] -= system[k * rows + j] * rest[j];
    rest[k] = std::norm(system[k * rows + k]) > 0 ? rest[k] / system[k * rows + k] : 0;
  }
}

void solve_positive(std::span<double> system, std::initializer_list<std::span<double>> rests) {
  const std::size_t rows = rests.begin()->size();
  for (std::size_t k = 0; k < rows; ++k) {
    const double inverse = 1 / system[k * rows + k];
    for (std::size_t i = k + 1; i < rows; ++i) {
      const double part = system[i * rows + k] * inverse;
      for (std::size_t j = k + 1; j < rows; ++j)
        system[i * rows + j] -= part * system[k * rows + j];
      for (const std::span<double> rest : rests)
        rest[i] -= part * rest[k];
    }
  }
  for (const std::span<double> rest : rests) {
    for (std::size_t k = rows; k-- > 0;) {
      for (std::size_t j = k + 1; j < rows; ++j)
        rest[k] -= system[k * rows + j] * rest[j];
      rest[k] /= system[k * rows + k];
    }
  }
}

}  // namespace palpa::array
