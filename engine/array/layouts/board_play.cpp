#include "array/layouts/board_play.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace palpa::array {
namespace {

constexpr double rounding = 1e-6;  // of amplitudes, which are floats

float loudest_of(std::span<const TransducerDrive> drive) {
  float loudest = 0;
  for (const TransducerDrive& one : drive)
    loudest = std::max(loudest, one.amplitude);
  return loudest;
}

}  // namespace

BoardPlay::BoardPlay(const Layout& layout) : factors_(layout.factors) {
  assert(factors_.empty() || factors_.size() == layout.transducers.size());
  for (const Board& board : layout.boards) {
    const BoardType* const type = find_board_type(board.type);
    if (type == nullptr) continue;
    const AmplitudeSteps* const steps = type->has_amplitudes() ? type->amplitudes() : nullptr;
    parts_.push_back({board.first, board.count, type, steps});
    float factor = 1;
    if (!factors_.empty()) factor = std::ranges::max(std::span(factors_).subspan(board.first, board.count));
    double least = steps ? steps->least() : 1.0 / board.count;
    least = factor > 0 ? least / factor : std::numeric_limits<double>::infinity();
    if (finest_ != nullptr && least >= least_) continue;
    least_ = least;
    finest_ = type;
  }
}

double BoardPlay::least_to_say() const {
  constexpr double digits = 1e4;
  return std::ceil(least_ * digits) / digits;
}

bool BoardPlay::sounds_at(double loudest) const {
  return loudest * (1 + rounding) >= least_;
}

template <typename Amplitude, typename Set>
void BoardPlay::play_part(const Part& part, float loudest, float most, const Amplitude& amplitude,
                          const Set& set) const {
  const std::uint32_t end = part.first + part.count;
  if (part.steps == nullptr) {
    const double share = std::clamp<double>(std::min(loudest, most), 0, 1);
    const auto on = static_cast<std::uint32_t>(std::floor(share * part.count * (1 + rounding)));
    for (std::uint32_t t = part.first; t < end; ++t)
      set(t, amplitude(t) > 0 && part.type->turn(t - part.first) < on ? 1.0f : 0.0f);
  } else if (factors_.empty()) {
    const std::size_t highest = part.steps->below(most);
    for (std::uint32_t t = part.first; t < end; ++t)
      set(t, part.steps->level(part.steps->nearest(amplitude(t), highest)));
  } else {
    for (std::uint32_t t = part.first; t < end; ++t) {
      const std::size_t highest = part.steps->below(most * factors_[t]);
      set(t, part.steps->level(part.steps->nearest(amplitude(t) * factors_[t], highest)));
    }
  }
}

void BoardPlay::round(std::span<TransducerDrive> drive, double ceiling) const {
  if (parts_.empty()) return;
  const float loudest = loudest_of(drive), most = std::min(loudest, static_cast<float>(ceiling));
  for (const Part& part : parts_) {
    assert(part.first + part.count <= drive.size());
    play_part(
        part, loudest, most, [&](std::uint32_t t) { return drive[t].amplitude; },
        [&](std::uint32_t t, float amplitude) { drive[t].amplitude = amplitude; });
  }
}

void BoardPlay::play(std::span<const TransducerDrive> drive, float factor, double ceiling,
                     std::span<float> amplitudes) const {
  const auto most = static_cast<float>(ceiling);
  const auto asked = [&](std::uint32_t t) { return drive[t].amplitude * factor; };
  for (std::uint32_t t = 0; t < drive.size(); ++t)
    amplitudes[t] = std::min(asked(t), most);
  const float loudest = loudest_of(drive) * factor;
  for (const Part& part : parts_)
    play_part(part, loudest, most, asked, [&](std::uint32_t t, float amplitude) { amplitudes[t] = amplitude; });
}

}  // namespace palpa::array
