#include "observer/kept_variants.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace palpa::observer {
namespace {

constexpr const char* decisions_kind = "decisions";
/// To be raised when the computation changes.
constexpr std::uint32_t decisions_version = 2;

/// Accuracy, whether there is an interval, its ends, error; then the shares.
constexpr std::size_t numbers_before_shares = 5;

}  // namespace

CacheKey key_of(const Responses& responses) {
  CacheHash hash;
  hash.add(responses.shapes.size());
  hash.add(responses.methods.size());
  hash.add(responses.depths_m);
  hash.add(responses.placements);
  hash.add(responses.levels.size());
  hash.add(responses.areas_cm2);
  hash.add(responses.seconds_counted);
  for (const TouchResponse& touch : responses.touches) {
    hash.add(touch.counts.size());
    for (const std::vector<float>& level : touch.counts)
      hash.add(level);
    for (const std::vector<float>* map : {&touch.at_once, &touch.mean_stress, &touch.flutter, &touch.vibration})
      hash.add(*map);
  }
  return hash.key();
}

CacheKey key_of(const CacheKey& responses, const PredictedStudy& study, const Variant& variant, std::size_t level,
                std::size_t points, double sigma) {
  CacheHash hash;
  hash.add(decisions_version);
  hash.add(responses);
  hash.add(study.fitted.method);
  hash.add(study.fitted.accuracy);
  hash.add(study.fitted.trials);
  hash.add(study.touch_s);
  hash.add(variant.cue);
  hash.add(variant.scale);
  hash.add(variant.classes);
  hash.add(variant.depth);
  hash.add(variant.placement);
  hash.add(level);
  hash.add(points);
  hash.add(sigma);
  return hash.key();
}

std::optional<PredictedVariant> load_variant(const CacheKey& key, std::size_t methods, std::size_t shapes) {
  const auto file = load_cached(decisions_kind, key);
  if (!file || file->sections.size() != 1) return {};
  std::span<const double> values = file->section_as<double>(0);
  const std::size_t of_a_method = numbers_before_shares + shapes * shapes;
  if (values.size() != 1 && values.size() != 1 + methods * of_a_method) return {};
  PredictedVariant variant;
  variant.sigma = values[0];
  values = values.subspan(1);
  for (; !values.empty(); values = values.subspan(of_a_method)) {
    PredictedMethod method{.accuracy = values[0], .fitted_interval = {}, .error = values[4], .shares = {}};
    if (values[1] != 0) method.fitted_interval = study::Interval{values[2], values[3]};
    const std::span<const double> shares = values.subspan(numbers_before_shares, shapes * shapes);
    method.shares.assign(shares.begin(), shares.end());
    variant.methods.push_back(std::move(method));
  }
  return variant;
}

void store_variant(const CacheKey& key, const PredictedVariant& variant) {
  std::vector<double> values{variant.sigma};
  for (const PredictedMethod& method : variant.methods) {
    const study::Interval interval = method.fitted_interval.value_or(study::Interval{});
    values.insert(values.end(),
                  {method.accuracy, method.fitted_interval ? 1.0 : 0.0, interval.low, interval.high, method.error});
    values.insert(values.end(), method.shares.begin(), method.shares.end());
  }
  const std::span<const std::byte> sections[]{std::as_bytes(std::span(values))};
  store_cached(decisions_kind, key, sections);
}

}  // namespace palpa::observer
