#include "array/layouts/amplitude_steps.hpp"

#include <algorithm>
#include <cassert>

namespace palpa::array {
namespace {

/// A few roundings of a float: a step times a factor of 1 must remain that step.
constexpr float rounding = 1 + 5e-7f;

}  // namespace

AmplitudeSteps::AmplitudeSteps(const std::vector<Step>& steps) {
  for (const Step& step : steps) {
    levels_.push_back(static_cast<float>(step.level));
    codes_.push_back(step.code);
  }
  assert(levels_.size() > 1 && levels_.size() <= 256 && levels_.front() == 0 && levels_.back() == 1);
  std::size_t number = 0;
  for (std::size_t i = 0; i <= entries; ++i) {
    while (number + 1 < levels_.size() && levels_[number + 1] * entries <= static_cast<float>(i))
      ++number;
    below_[i] = static_cast<std::uint8_t>(number);
  }
}

std::size_t AmplitudeSteps::below(float amplitude) const {
  if (!(amplitude > 0)) return 0;
  const float wanted = std::min(amplitude * rounding, 1.0f);
  std::size_t number = below_[static_cast<std::size_t>(wanted * entries)];
  while (number + 1 < levels_.size() && levels_[number + 1] <= wanted)
    ++number;
  return number;
}

std::size_t AmplitudeSteps::nearest(float amplitude, std::size_t most) const {
  const std::size_t number = below(amplitude);
  if (number >= most) return most;
  return amplitude - levels_[number] > levels_[number + 1] - amplitude ? number + 1 : number;
}

}  // namespace palpa::array
