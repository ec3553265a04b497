#include "sensing/background.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace palpa::sensing {
namespace {

constexpr double percentile = 0.02;
constexpr double least_margin_m = 2e-3, margin_in_noises = 3, unsteady_in_noises = 6, steady_share = 0.98;

/// The number of the percentile among `count` ascending values, from 0: the nearest rank.
std::size_t rank_of(std::uint64_t count) {
  return static_cast<std::size_t>(std::max(std::ceil(percentile * static_cast<double>(count)), 1.0)) - 1;
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

BackgroundFrames::BackgroundFrames(const Camera& camera, std::uint64_t frames)
    : camera_(camera), most_frames_(frames), kept_(rank_of(frames) + 1) {
  const std::size_t pixels = pixel_count(camera);
  nearest_.assign(pixels * kept_, std::numeric_limits<std::uint16_t>::max());
  counts_.assign(pixels, 0);
  sums_.assign(pixels, 0);
  squares_.assign(pixels, 0);
}

void BackgroundFrames::add(std::span<const std::uint16_t> depth) {
  if (depth.size() != counts_.size()) throw bad_usage("a depth frame has another size than its camera");
  if (frames_ == most_frames_) throw bad_usage("more frames than a background was to be learned from");
  ++frames_;
  const std::uint32_t first = first_valid_depth(camera_);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::uint64_t d = depth[i];
    if (d < first) continue;
    ++counts_[i];
    sums_[i] += d;
    squares_[i] += d * d;
    std::uint16_t* const nearest = nearest_.data() + i * kept_;
    if (depth[i] >= nearest[kept_ - 1]) continue;
    std::size_t place = kept_ - 1;
    for (; place > 0 && nearest[place - 1] > depth[i]; --place)
      nearest[place] = nearest[place - 1];
    nearest[place] = depth[i];
  }
}

LearnedBackground BackgroundFrames::finish() const {
  LearnedBackground learned;
  learned.background.depth.assign(counts_.size(), 0);
  std::vector<double> noises;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] == 0) continue;
    learned.background.depth[i] = nearest_[i * kept_ + rank_of(counts_[i])];
    const double n = counts_[i], mean = static_cast<double>(sums_[i]) / n;
    const double variance = std::max(static_cast<double>(squares_[i]) / n - mean * mean, 0.0);
    const double z = mean * camera_.depth_unit_m;
    noises.push_back(std::sqrt(variance) * camera_.depth_unit_m / std::max(1.0, z * z));
  }
  learned.pixels = noises.size();
  // Rounding alone makes a pixel's depths differ by a unit.
  const double most = std::max(unsteady_in_noises * quantile(noises, 0.5), 2 * camera_.depth_unit_m);
  std::erase_if(noises, [&](double noise) { return noise > most; });
  learned.unsteady = learned.pixels - noises.size();
  learned.noise_m = quantile(noises, steady_share);
  const double margin = std::max(least_margin_m, margin_in_noises * learned.noise_m);
  learned.background.margin_m = std::ceil(margin * 1e4) / 1e4;
  return learned;
}

}  // namespace palpa::sensing
