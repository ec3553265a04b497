// The passes of a climb (climb.hpp) over all transducers, eight of them at a time in single precision. The same bytes
// for any processor.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"

namespace palpa::array {

inline constexpr std::size_t lanes_together = 8;

/// G, entry [(block * foci + focus) * lanes_together + lane]. Lanes without a transducer have no sound.
struct LaneColumns {
  std::size_t foci = 0, transducers = 0, blocks = 0;
  std::vector<float> re, im;
};
/// x of all transducers.
struct LaneDrives {
  std::vector<float> re, im;
};

/// Replaces `lanes`, keeping the storage: up to `count` transducers that are spread over the array, or all in their
/// order.
void take_lanes(const Columns& columns, std::size_t count, LaneColumns& lanes);

/// p = G x.
void hear_lanes(const LaneColumns& columns, const LaneDrives& drive, std::span<std::complex<double>> pressure);

/// D_n = |sum over j of stiff_j G_jn x_n| + soft.
struct Stiffness {
  std::span<const std::complex<double>> stiff;  ///< by focus
  double soft = 0;
};

/// Turns each transducer by -Im(sum over j of pull_j G_jn x_n) / (stiffness D_n), at most `most_turn`. Fills `tried`
/// and its pressure.
void turn_lanes(const LaneColumns& columns, const LaneDrives& drive, std::span<const std::complex<double>> pull,
                const Stiffness& held, double stiffness, double most_turn, LaneDrives& tried,
                std::span<std::complex<double>> pressure);

/// Fills K_jk = sum over n of J_jn J_kn / D_n, J_jn = -Im(turn_j G_jn x_n), rows of `foci`, from every `every`-th
/// block, each counted `every` times.
void find_growth(const LaneColumns& columns, const LaneDrives& drive, std::span<const std::complex<double>> turn,
                 const Stiffness& held, std::size_t every, std::span<double> growth);

}  // namespace palpa::array
