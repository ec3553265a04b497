// What the observer keeps between runs is found by everything that it depends on.
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "observer/kept_variants.hpp"
#include "support/own_cache.hpp"
#include "support/shared_data.hpp"

namespace palpa::observer {
namespace {

Responses some_responses() {
  Responses responses;
  responses.shapes.resize(2);
  responses.methods.resize(1);
  responses.depths_m = {1e-3};
  responses.placements = 2;
  responses.levels.resize(1);
  responses.areas_cm2 = {1, 2};
  responses.seconds_counted = 0.5;
  TouchResponse touch;
  touch.counts = {{1, 2}};
  touch.at_once = touch.mean_stress = touch.flutter = touch.vibration = {1, 2};
  responses.touches.assign(4, touch);
  return responses;
}

TEST(KeptVariants, ResponsesAreTheSameOnlyIfAllOfThemIs) {
  const std::function<void(Responses&)> changes[]{
      [](Responses&) {},
      [](Responses& r) { r.shapes.resize(3); },
      [](Responses& r) { r.methods.resize(2); },
      [](Responses& r) { r.depths_m[0] = 2e-3; },
      [](Responses& r) { r.placements = 3; },
      [](Responses& r) { r.levels.resize(2); },
      [](Responses& r) { r.areas_cm2[1] = 3; },
      [](Responses& r) { r.seconds_counted = 0.6; },
      [](Responses& r) { r.touches[3].counts[0][1] = 3; },
      [](Responses& r) { r.touches[2].counts.clear(); },
      [](Responses& r) { r.touches[1].at_once[0] = 3; },
      [](Responses& r) { r.touches[1].mean_stress[0] = 3; },
      [](Responses& r) { r.touches[1].flutter[0] = 3; },
      [](Responses& r) { r.touches[1].vibration[0] = 3; },
      [](Responses& r) { std::swap(r.touches[0].flutter[0], r.touches[0].flutter[1]); }};
  std::set<CacheKey> keys;
  for (const auto& change : changes) {
    Responses responses = some_responses();
    change(responses);
    EXPECT_TRUE(keys.insert(key_of(responses)).second) << keys.size();
  }
  EXPECT_FALSE(keys.insert(key_of(some_responses())).second);
}

struct Asked {
  CacheKey responses{1, 2};
  PredictedStudy study;
  Variant variant{};
  std::size_t level = 1, points = 5;
  double sigma = 0.5;
};

TEST(KeptVariants, AVariantIsFoundByAllThatItDependsOnAndReadBack) {
  const test::OwnCache cache(test::scratch_folder("kept-variants"));
  const std::function<void(Asked&)> changes[]{
      [](Asked&) {},
      [](Asked& a) {
        a.responses = {1, 3};
      },
      [](Asked& a) { ++a.study.fitted.method; },
      [](Asked& a) { a.study.fitted.accuracy += 0.1; },
      [](Asked& a) { ++a.study.fitted.trials; },
      [](Asked& a) { a.study.touch_s += 1; },
      [](Asked& a) { a.variant.cue = static_cast<decltype(a.variant.cue)>(static_cast<int>(a.variant.cue) + 1); },
      [](Asked& a) { a.variant.scale = static_cast<decltype(a.variant.scale)>(static_cast<int>(a.variant.scale) + 1); },
      [](Asked& a) {
        a.variant.classes = static_cast<decltype(a.variant.classes)>(static_cast<int>(a.variant.classes) + 1);
      },
      [](Asked& a) { a.variant.depth = static_cast<decltype(a.variant.depth)>(static_cast<int>(a.variant.depth) + 1); },
      [](Asked& a) {
        a.variant.placement = static_cast<decltype(a.variant.placement)>(static_cast<int>(a.variant.placement) + 1);
      },
      [](Asked& a) { ++a.level; },
      [](Asked& a) { ++a.points; },
      [](Asked& a) { a.sigma += 0.1; }};
  const auto key = [](const Asked& a) { return key_of(a.responses, a.study, a.variant, a.level, a.points, a.sigma); };
  std::set<CacheKey> keys;
  for (const auto& change : changes) {
    Asked asked;
    change(asked);
    EXPECT_FALSE(load_variant(key(asked), 2, 2)) << keys.size();
    EXPECT_TRUE(keys.insert(key(asked)).second) << keys.size();
    PredictedVariant variant;
    variant.sigma = 0.1 * static_cast<double>(keys.size());
    for (const double accuracy : {0.4, 0.6}) {
      variant.methods.push_back({.accuracy = accuracy, .fitted_interval = {}, .error = 0.01, .shares = {}});
      variant.methods.back().shares = {accuracy, 1 - accuracy, 0.3, 0.7};
    }
    variant.methods[1].fitted_interval = study::Interval{0.5, 0.7};
    store_variant(key(asked), variant);
    const auto kept = load_variant(key(asked), 2, 2);
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->sigma, variant.sigma);
    for (std::size_t m = 0; m < 2; ++m) {
      EXPECT_EQ(kept->methods[m].accuracy, variant.methods[m].accuracy);
      EXPECT_EQ(kept->methods[m].error, 0.01);
      EXPECT_EQ(kept->methods[m].shares, variant.methods[m].shares);
      EXPECT_EQ(kept->methods[m].fitted_interval.has_value(), m == 1);
    }
    EXPECT_EQ(kept->methods[1].fitted_interval->high, 0.7);
  }
}

}  // namespace
}  // namespace palpa::observer
