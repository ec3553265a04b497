// Sampling rules for integrals over triangles and pairs of triangles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpa::acoustics {

/// A sample of the triangle u, v >= 0, u + v <= 1. Weights of a rule sum to its area, 1/2.
struct TriangleSample {
  double u, v, weight;
};

/// Exact for polynomials of degree 2: three samples, sample i near corner i.
std::span<const TriangleSample> three_point_rule();
/// The hat function of a corner at a sample of this rule.
inline double hat_at_sample(std::size_t corner, std::size_t sample) {
  return corner == sample ? 2.0 / 3 : 1.0 / 6;
}
/// Exact for polynomials of degree 4: six points (Dunavant 1985).
std::span<const TriangleSample> six_point_rule();

/// A sample of two triangles at once. The weights of a rule sum to 1/4.
struct PairSample {
  double u, v, other_u, other_v, weight;
};

/// How two patches touch. `corner`: their first corners are the same vertex. `edge`: their first two corners are the
/// same, in the same order. `same`: they are the same patch.
enum class Touch { corner, edge, same };

/// For integrands as singular as 1/distance. Changes of variables remove the singularity, and the smooth remainder is
/// sampled by products of Gauss rules of `points` each in four variables (Sauter and Schwab 2011, "Boundary Element
/// Methods", 5.2). A rule has 2 (corner), 5 (edge) or 6 (same) times points^4 samples.
std::vector<PairSample> touching_rule(Touch touch, std::size_t points);

/// Samples and weights of Gauss' rule on [0, 1]; 1 to a few hundred points.
struct LineSample {
  double at, weight;
};
std::vector<LineSample> gauss_rule(std::size_t points);

}  // namespace palpa::acoustics
