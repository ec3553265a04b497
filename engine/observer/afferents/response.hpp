// How afferents respond to the skin around them.
//
// The input of an afferent is two signals at its site: the vertical stress below it (N/mm2; only SA1 use it) and a
// dynamic signal, E / (1 - nu^2) times the velocity of the surface (mm/s) divided by the square of its depth in mm.
//
//   filter    third-order Butterworth low-pass, causal: s from the stress, u from the dynamic signal
//   current   I = p1 [s]+ + p2 [s]- + p3 [u]+ + p4 [u]- + p5 [v]+ + p6 [v]-,  v = u(n + 1) - u(n);
//             if it saturates: I <- p7 I / (p7 + |I|)
//   membrane  V <- V - V / memory + I + h; a spike if V > 1 and more than 5 samples after the last; then V <- 0
//   h         p10 b1(n) + p11 b2(n) in the n-th sample after the last spike, n < 190, where
//             b(n) = (1 + cos(min(pi, k |ln((n + 5) / c)|))) / 2, k = 3 pi / (4 ln 3), c = 5 and 45
//
// TouchSim can also add noise to the current, which alone makes none of the models fire. It is left out, so the same
// input gives the same spikes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "observer/afferents/models.hpp"

namespace palpa::observer {

/// A signal at many sites over time. Four sites lie side by side, so that they are computed together.
class SiteSignal {
 public:
  SiteSignal() = default;
  SiteSignal(std::size_t sites, std::size_t samples);

  std::size_t sites() const { return sites_; }
  std::size_t samples() const { return samples_; }
  double& at(std::size_t site, std::size_t sample) { return values_[(site / 4 * samples_ + sample) * 4 + site % 4]; }
  double at(std::size_t site, std::size_t sample) const {
    return values_[(site / 4 * samples_ + sample) * 4 + site % 4];
  }
  /// The four sites from 4 * block on, sample after sample. Sites beyond the last are 0.
  const double* block(std::size_t block) const { return &values_[block * samples_ * 4]; }
  std::size_t blocks() const { return (sites_ + 3) / 4; }

 private:
  std::size_t sites_ = 0, samples_ = 0;
  std::vector<double> values_;
};

/// What is at the sites: stress at 0.3 mm, and the velocity of the surface in mm/s. Both have the same size.
struct SkinMotion {
  SiteSignal stress, velocity;
};

/// The spikes of one model at every site.
struct Spikes {
  std::vector<std::uint32_t> counts;         ///< per site
  std::vector<std::vector<double>> times{};  ///< per site, in s, ascending; empty unless requested
};
enum class SpikeTimes { no, yes };

/// The response of `model` at every site, each starting at rest. All signals are multiplied by `level`. Counts leave
/// out spikes before the sample `from`; times do not. Uses the calling thread only. The same bits on every processor.
Spikes respond(const SkinMotion& motion, const AfferentModel& model, double level = 1, std::size_t from = 0,
               SpikeTimes times = SpikeTimes::no);

}  // namespace palpa::observer
