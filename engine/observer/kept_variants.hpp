// Decisions of the ideal observer, kept between runs by the content of everything that they depend on.
#pragma once

#include <cstddef>
#include <optional>

#include "base/files/cache_file.hpp"
#include "observer/prediction.hpp"

namespace palpa::observer {

/// The same for responses that differ in names only.
CacheKey key_of(const Responses& responses);

/// What the prediction of a variant depends on. The parts of the study that only concern simulated studies are left
/// out. `sigma`: the noise if it is not fitted, or 0.
CacheKey key_of(const CacheKey& responses, const PredictedStudy& study, const Variant& variant, std::size_t level,
                std::size_t points, double sigma);

/// The noise and the methods of a variant, without its names. Empty if it is not kept.
std::optional<PredictedVariant> load_variant(const CacheKey& key, std::size_t methods, std::size_t shapes);
void store_variant(const CacheKey& key, const PredictedVariant& variant);

}  // namespace palpa::observer
