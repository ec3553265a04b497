// The responses to one method's touches of one shape, kept between runs by the content of everything that they depend
// on. Since they are kept as soon as a shape is done, a computation that is broken off goes on there the next time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/files/cache_file.hpp"
#include "experiment/touch_patterns.hpp"
#include "observer/responses.hpp"

namespace palpa::experiment {

/// The touches of a shape with a method: every depth and placement, in the order of observer::Responses.
using ShapeResponses = std::vector<observer::TouchResponse>;

/// What the touches of a shape depend on, beside the method.
struct ResponseSource {
  const ObservedFinger& finger;
  const std::vector<geometry::Solid>& solids;
  const std::vector<double>& depths_m;
  const std::vector<observer::FingerPlace>& places;
  const std::vector<double>& factors;  ///< of the levels
};
CacheKey key_of(const ResponseSource& source, const ObservedMethod& method);

std::optional<ShapeResponses> load_responses(const CacheKey& key, std::size_t touches, std::size_t sites,
                                             std::size_t levels);
void store_responses(const CacheKey& key, const ShapeResponses& responses);

/// A single number, under the same rules.
std::optional<double> load_number(const CacheKey& key);
void store_number(const CacheKey& key, double value);

}  // namespace palpa::experiment
