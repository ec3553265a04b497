// The responses to one method's touches, kept between runs by the content of everything that they depend on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/cache_file.hpp"
#include "setup/experiment/touch_patterns.hpp"
#include "study/observer/responses.hpp"

namespace palpa::setup {

/// All touches of a method: every shape, depth and placement, in the order of study::Responses.
using MethodResponses = std::vector<study::TouchResponse>;

/// What the touches of a method depend on.
struct ResponseSource {
  const ObservedFinger& finger;
  std::vector<TouchedScene> shapes;  ///< without depth
  const std::vector<double>& depths_m;
  const std::vector<study::FingerPlace>& places;
  const std::vector<double>& factors;  ///< of the levels
};
CacheKey key_of(const ResponseSource& source, const ObservedMethod& method);

std::optional<MethodResponses> load_responses(const CacheKey& key, std::size_t touches, std::size_t sites,
                                              std::size_t levels);
void store_responses(const CacheKey& key, const MethodResponses& responses);

/// A single number, under the same rules.
std::optional<double> load_number(const CacheKey& key);
void store_number(const CacheKey& key, double value);

}  // namespace palpa::setup
