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

/// With Round::down, the transducers that are on have less in sum than the drive asks for, because each is at full
/// amplitude, and those that are on may be nearer to a focus than the others.
void turn_on(const BoardType& type, std::span<TransducerDrive> drive, float ceiling, Round how) {
  constexpr double nearer = 0.95;
  double sum = 0;
  for (const TransducerDrive& one : drive)
    sum += std::clamp<double>(one.amplitude, 0, ceiling);
  const double all = static_cast<double>(drive.size()) * std::clamp<double>(ceiling, 0, 1);
  const double most = how == Round::down ? std::min(all, nearer * sum) : all;
  const auto on = static_cast<std::uint32_t>(std::floor(most * (1 + rounding)));
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

double BoardPlay::least_to_say() const {
  constexpr double digits = 1e4;
  return std::ceil(least_ * digits) / digits;
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
    part.steps ? round_to(*part.steps, own, most, how) : turn_on(*part.type, own, most, how);
  }
}

}  // namespace palpa::array
