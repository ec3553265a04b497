// The inner loops of Incident: one transducer's sound at a block of points. Each is plain arithmetic on arrays of equal
// length, which the compiler vectorises. Each is compiled for several kinds of processor, and the best available
// version is used. No version fuses or reorders operations, so all give the same bytes.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

/// Points in a block.
inline constexpr std::size_t block_points = 64;

template <typename T>
using BlockOf = std::array<T, block_points>;

/// A block of the points. If fewer remain, the last one is repeated.
struct PointBlock {
  BlockOf<double> x, y, z;
  BlockOf<float> nx, ny, nz;
  std::size_t count;

  /// The points from `first` on. `normals` may be empty.
  PointBlock(std::span<const Vec3> points, std::span<const Vec3> normals, std::size_t first);
};

/// G of one transducer (incident.hpp) at a block's points, and its slope along their normals.
struct TransferBlock {
  BlockOf<float> re, im, slope_re, slope_im;
};

/// The parameters of G other than the places.
struct TransferSetting {
  /// The directivity between two entries of its table: value + rise * (0..1).
  struct Entry {
    float value, rise;
  };
  std::vector<Entry> table;
  double turns_per_metre;
  float wave_number, absorption;
  float closest;  ///< 1/r is constant below this distance

  TransferSetting(const array::Layout& layout, const Air& air, array::Directivity directivity);
};

/// Fills `out`, but its slopes only if `slopes`.
void transfer(const TransferSetting& setting, const array::Transducer& from, const PointBlock& to, bool slopes,
              TransferBlock& out);

/// The sound of a drive at a block's points.
struct SumBlock {
  BlockOf<float> re{}, im{}, slope_re{}, slope_im{};
};

/// Adds s G of each transducer, one after the other, where s is its strength. Adds the slopes only if `slopes`.
void add_products(std::span<const std::complex<float>> strengths, std::span<const TransferBlock> sounds, bool slopes,
                  SumBlock& sum);

/// Adds the slopes of G, times this factor, to G.
void add_slopes(std::complex<float> factor, TransferBlock& sound);

/// The reverse: sources at a block's points, padded with zeros.
struct SourceBlock {
  BlockOf<float> re{}, im{};
};

/// Sums of every sixteenth point, side by side.
inline constexpr std::size_t sum_lanes = 16;
struct LaneSums {
  std::array<float, sum_lanes> re{}, im{};
  std::complex<double> total() const;
};

/// Adds the sum over the block of each source times G, for each row of sources.
void add_received(std::span<const SourceBlock> rows, const TransferBlock& sound, std::span<LaneSums> sums);

}  // namespace palpa::acoustics
