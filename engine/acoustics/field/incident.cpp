#include "acoustics/field/incident.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/activity.hpp"
#include "base/system/memory.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {

using array::Layout;
using Complex = std::complex<double>;

Incident::Incident(const Layout& layout, const Air& air, array::Directivity directivity)
    : layout_(layout), setting_(layout, air, directivity) {}

Strengths strengths_of(std::span<const array::TransducerDrive> drive) {
  Strengths strengths(drive.size());
  std::ranges::transform(drive, strengths.begin(), [](const array::TransducerDrive& d) {
    return std::polar(static_cast<double>(d.amplitude), static_cast<double>(d.phase));
  });
  return strengths;
}

namespace {

/// Transducers that are summed in single precision before the result is added to the double sum.
constexpr std::size_t batch = 128;
/// Transducers whose sound is kept for all drives: what fits into the fastest cache.
constexpr std::size_t at_hand = 16;
static_assert(batch % at_hand == 0);

/// One drive's sum over transducers at a block's points: a batch in single precision, all batches in double.
struct Sum {
  SumBlock part;
  BlockOf<double> re{}, im{}, slope_re{}, slope_im{};

  void end_batch() {
    for (std::size_t i = 0; i < block_points; ++i) {
      re[i] += static_cast<double>(part.re[i]);
      im[i] += static_cast<double>(part.im[i]);
      slope_re[i] += static_cast<double>(part.slope_re[i]);
      slope_im[i] += static_cast<double>(part.slope_im[i]);
    }
    part = {};
  }
};

void store(double level, const BlockOf<double>& re, const BlockOf<double>& im, std::span<Complex> into) {
  for (std::size_t i = 0; i < into.size(); ++i)
    into[i] = level * Complex(re[i], im[i]);
}

}  // namespace

bool Incident::at(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const Complex> strengths,
                  Waves& waves, const std::atomic<bool>* give_up) const {
  const std::size_t transducers = layout_.transducers.size();
  const std::size_t drives = transducers == 0 ? 0 : strengths.size() / transducers;
  const bool sloped = !normals.empty();
  assert(strengths.size() == drives * transducers && (!sloped || normals.size() == points.size()));
  reserve_large(waves.pressures, drives * points.size());
  waves.pressures.assign(drives * points.size(), 0);
  waves.slopes.assign(sloped ? drives * points.size() : 0, 0);
  if (drives == 0) return true;

  std::vector<std::complex<float>> single(strengths.size());
  std::ranges::transform(strengths, single.begin(), [](const Complex& s) { return std::complex<float>(s); });
  Activity activity("summing the sound of transducers", points.size());
  parallel_chunks(points.size(), block_points, [&](std::size_t, std::size_t begin, std::size_t) {
    if (give_up && *give_up) return;
    const PointBlock block(points, normals, begin);
    std::array<TransferBlock, at_hand> sounds;
    std::vector<Sum> sums(drives);
    for (std::size_t first = 0; first < transducers; first += at_hand) {
      const std::size_t count = std::min(at_hand, transducers - first);
      for (std::size_t i = 0; i < count; ++i)
        transfer(setting_, layout_.transducers[first + i], block, sloped, sounds[i]);
      const bool ends = (first + at_hand) % batch == 0 || first + at_hand >= transducers;
      for (std::size_t d = 0; d < drives; ++d) {
        add_products(std::span(single).subspan(d * transducers + first, count), std::span(sounds).first(count), sloped,
                     sums[d].part);
        if (ends) sums[d].end_batch();
      }
    }
    const double level = layout_.source_level_pa_m;
    for (std::size_t d = 0; d < drives; ++d) {
      const std::size_t first = d * points.size() + begin;
      store(level, sums[d].re, sums[d].im, std::span(waves.pressures).subspan(first, block.count));
      if (sloped) store(level, sums[d].slope_re, sums[d].slope_im, std::span(waves.slopes).subspan(first, block.count));
    }
    activity.advance(block.count);
  });
  return !(give_up && *give_up);
}

namespace {

/// Blocks that are summed in single precision before the result is added to the double sum.
constexpr std::size_t blocks_at_once = 32;

/// The sources of a row at the points from `first` on.
SourceBlock sources_at(std::span<const Complex> strengths, std::size_t first, std::size_t count) {
  SourceBlock block;
  for (std::size_t i = 0; i < count; ++i) {
    block.re[i] = static_cast<float>(strengths[first + i].real());
    block.im[i] = static_cast<float>(strengths[first + i].imag());
  }
  return block;
}

}  // namespace

bool Incident::received(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const Complex> strengths,
                        Complex slope, std::vector<Complex>& received, const std::atomic<bool>* give_up) const {
  const std::size_t transducers = layout_.transducers.size(), count = points.size();
  const std::size_t rows = count == 0 ? 0 : strengths.size() / count;
  const bool sloped = !normals.empty();
  assert(strengths.size() == rows * count && (!sloped || normals.size() == count));
  received.assign(rows * transducers, 0);

  std::vector<PointBlock> blocks;
  std::vector<SourceBlock> sources;  // [block * rows + row]
  for (std::size_t first = 0; first < count; first += block_points) {
    blocks.emplace_back(points, normals, first);
    for (std::size_t row = 0; row < rows; ++row)
      sources.push_back(sources_at(strengths, row * count + first, blocks.back().count));
  }
  // Each thread has its own transducers and sums over the points in order, so results do not depend on the threads.
  constexpr std::size_t at_once = 16;
  Activity activity("summing the sound at transducers", transducers);
  parallel_chunks(transducers, at_once, [&](std::size_t, std::size_t begin, std::size_t end) {
    if (give_up && *give_up) return;
    TransferBlock sound;
    std::vector<LaneSums> sums(rows * (end - begin));
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      for (std::size_t t = begin; t < end; ++t) {
        transfer(setting_, layout_.transducers[t], blocks[b], sloped, sound);
        if (sloped) add_slopes(std::complex<float>(slope), sound);
        add_received(std::span(sources).subspan(b * rows, rows), sound,
                     std::span(sums).subspan((t - begin) * rows, rows));
      }
      if ((b + 1) % blocks_at_once != 0 && b + 1 < blocks.size()) continue;
      for (std::size_t t = begin; t < end; ++t) {
        for (std::size_t row = 0; row < rows; ++row)
          received[row * transducers + t] += layout_.source_level_pa_m * sums[(t - begin) * rows + row].total();
      }
      std::ranges::fill(sums, LaneSums());
    }
    activity.advance(end - begin);
  });
  return !(give_up && *give_up);
}

}  // namespace palpa::acoustics
