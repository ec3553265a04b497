// The interval of a proportion, k of n independent trials.
#pragma once

#include <cstdint>

#include "study/statistics/moments.hpp"

namespace palpa::study {

/// The exact 95 % interval of Clopper and Pearson. n must be positive.
Interval clopper_pearson(std::uint64_t k, std::uint64_t n);

}  // namespace palpa::study
