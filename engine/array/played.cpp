#include "array/played.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace palpa::array {
namespace {

constexpr double rounding = 1e-6;  // of amplitudes, which are floats

void round_to(const AmplitudeSteps& steps, std::span<TransducerDrive> drive, float ceiling, Round how) {
  const std::size_t most = steps.below(ceiling);
  for (TransducerDrive& one : drive) {
    const std::size_t step =
        how == Round::down ? std::min(steps.below(one.amplitude), most) : steps.nearest(one.amplitude, most);
    one.amplitude = steps.level(step);
  }
}

void turn_on(const BoardType& type, std::span<TransducerDrive> drive, float ceiling) {
  const double share = std::clamp<double>(ceiling, 0, 1) * (1 + rounding);
  const auto on = static_cast<std::uint32_t>(std::floor(static_cast<double>(drive.size()) * share));
  for (std::uint32_t t = 0; t < drive.size(); ++t)
    drive[t].amplitude = drive[t].amplitude > 0 && type.turn(t) < on ? 1.0f : 0.0f;
}

}  // namespace

BoardPlay::BoardPlay(const Layout& layout) {
  for (const Board& board : layout.boards) {
    const BoardType* const type = find_board_type(board.type);
    if (type == nullptr) continue;
    const AmplitudeSteps* const steps = type->has_amplitudes() ? type->amplitudes() : nullptr;
    parts_.push_back({board.first, board.count, type, steps});
    if (const double least = steps ? steps->least() : 1.0 / board.count; finest_ == nullptr || least < least_) {
      least_ = least;
      finest_ = type;
    }
  }
}

bool BoardPlay::sounds_at(double loudest) const {
  return loudest * (1 + rounding) >= least_;
}

void BoardPlay::round(std::span<TransducerDrive> drive, double ceiling, Round how) const {
  if (parts_.empty()) return;
  float loudest = 0;
  for (const TransducerDrive& one : drive)
    loudest = std::max(loudest, one.amplitude);
  const float most = std::min(loudest, static_cast<float>(ceiling));
  for (const Part& part : parts_) {
    assert(part.first + part.count <= drive.size());
    const std::span<TransducerDrive> own = drive.subspan(part.first, part.count);
    part.steps ? round_to(*part.steps, own, most, how) : turn_on(*part.type, own, most);
  }
}

}  // namespace palpa::array
