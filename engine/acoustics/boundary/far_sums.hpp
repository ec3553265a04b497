// The far field of a surface's double layer in a direction: the inner loop of far_force.hpp, for the processor in use.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "base/math.hpp"

namespace palpa::acoustics {

/// Samples of a surface: positions in wavelengths, and area vectors in m2. Padded with samples of no area.
class FarSamples {
 public:
  /// Positions relative to `centre`. `points`, `normals` and `areas` have the same length.
  FarSamples(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const double> areas,
             const Vec3& centre, double wave_number);

  std::size_t padded() const { return of_[0].size(); }
  const float* numbers(std::size_t which) const { return of_[which].data(); }

 private:
  std::array<std::vector<float>, 6> of_;  // x, y, z, area x, y, z
};

/// Replaces `sums`, one per wave, by the sums over the samples of p s.a e^{-ik s.x}. `pressures` has the real parts of
/// p at all padded samples and then the imaginary parts, wave after wave.
void far_sums(const FarSamples& samples, const Vec3& direction, std::span<const float> pressures,
              std::span<std::complex<double>> sums);

}  // namespace palpa::acoustics
