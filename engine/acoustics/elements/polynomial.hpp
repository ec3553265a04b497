// Polynomials of two coordinates, and their fit by least squares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpa::acoustics {

inline constexpr std::uint32_t most_degree = 5;

/// The number of coefficients of a polynomial of this degree.
constexpr std::size_t terms_of(std::uint32_t degree) {
  return std::size_t{degree + 1} * (degree + 2) / 2;
}
inline constexpr std::size_t most_terms = terms_of(most_degree);

/// The monomials s^i t^j of a degree in the order 1, s, t, s^2, s t, t^2, ...; the first terms_of(degree) of them.
using Monomials = std::array<double, most_terms>;
Monomials monomials(std::uint32_t degree, double s, double t);
/// Their derivatives by s and t.
struct MonomialSlopes {
  Monomials by_s, by_t;
};
MonomialSlopes monomial_slopes(std::uint32_t degree, double s, double t);

/// The sums of a least-squares fit with `terms` unknowns, at most most_terms.
class LeastSquares {
 public:
  explicit LeastSquares(std::size_t terms) : terms_(terms), matrix_(terms * terms) {}

  /// An equation: row . unknowns = right, with this weight.
  void add(const Monomials& row, double weight);
  /// Call once after all equations. Directions that the equations leave open become zero.
  void factor();
  /// Replaces a sum of weight * right * row over the equations by the unknowns; for `count` right sides at once, entry
  /// [unknown * count + side].
  void solve(std::span<double> sums, std::size_t count = 1) const;

 private:
  std::size_t terms_;
  std::vector<double> matrix_;  // its lower triangle
};

}  // namespace palpa::acoustics
