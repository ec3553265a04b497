#include "observer/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/random.hpp"
#include "observer/decision.hpp"
#include "observer/kept_variants.hpp"
#include "observer/templates.hpp"
#include "study/statistics/proportions.hpp"
#include "study/tables/dprime.hpp"

namespace palpa::observer {
namespace {

using study::Interval;

/// The slope of one method's accuracy over another's, at both ends of the interval.
double slope(const Interval& of, const Interval& over) {
  return over.high > over.low ? (of.high - of.low) / (over.high - over.low) : 1;
}

/// The scatter of the accuracies of independent parts. A part with a higher accuracy of the fitted method would have
/// got more noise, so its other accuracies are lowered along the slope.
double error_of(const Decisions& decisions, const Decisions& fitted, double slope) {
  double square = 0;
  for (std::size_t i = 0; i < noise_parts; ++i) {
    const double apart = decisions.by_part[i] - decisions.accuracy - slope * (fitted.by_part[i] - fitted.accuracy);
    square += apart * apart;
  }
  return std::sqrt(square / (noise_parts - 1) / noise_parts);
}

/// The deviates of observers by their number of templates, which are drawn once.
class AllNormals {
 public:
  explicit AllNormals(std::size_t points) : points_(points) {}

  std::size_t points() const { return points_; }
  const Normals& for_templates(const Templates& templates) {
    const auto found = made_.find(templates.size());
    if (found != made_.end()) return found->second;
    return made_.try_emplace(templates.size(), templates.placements, templates.size(), points_).first->second;
  }

 private:
  std::size_t points_;
  std::map<std::size_t, Normals> made_;
};

PredictedVariant predict_variant(const Responses& responses, const PredictedStudy& study, const Interval& interval,
                                 const Variant& variant, std::size_t level, AllNormals& normals) {
  PredictedVariant out{.name = variant.name, .what = variant.what, .sigma = 0, .methods = {}};
  const double seconds = study.touch_s / static_cast<double>(responses.depths_m.size());
  const std::size_t fitted = study.fitted.method;
  const Templates basis = templates_of(responses, fitted, variant, level, seconds);
  const Observer observer(basis, normals.for_templates(basis));
  out.sigma = sigma_for(observer, basis, study.fitted.accuracy);
  if (out.sigma == 0) return out;
  const double least_noise = sigma_for(observer, basis, interval.high),
               most_noise = sigma_for(observer, basis, interval.low);
  const bool has_ends = least_noise > 0 && most_noise > 0;
  const Decisions of_fitted = observer.decide(out.sigma);
  for (std::size_t m = 0; m < responses.methods.size(); ++m) {
    PredictedMethod method;
    if (m == fitted) {
      method = {.accuracy = of_fitted.accuracy, .fitted_interval = interval, .error = 0, .shares = of_fitted.shares};
    } else {
      const Templates templates = templates_of(responses, m, variant, level, seconds);
      const Observer other(templates, normals.for_templates(templates));
      const Decisions decisions = other.decide(out.sigma);
      method = {.accuracy = decisions.accuracy, .fitted_interval = {}, .error = 0, .shares = decisions.shares};
      double steepness = 1;
      if (has_ends) {
        const Interval ends{other.decide(most_noise).accuracy, other.decide(least_noise).accuracy};
        method.fitted_interval = ends;
        steepness = slope(ends, interval);
      }
      method.error = error_of(decisions, of_fitted, steepness);
    }
    out.methods.push_back(std::move(method));
  }
  return out;
}

/// All methods with this noise, which is not fitted.
PredictedVariant predict_with(double sigma, const Responses& responses, const PredictedStudy& study,
                              const Variant& variant, std::size_t level, AllNormals& normals) {
  PredictedVariant out{.name = variant.name, .what = variant.what, .sigma = sigma, .methods = {}};
  const double seconds = study.touch_s / static_cast<double>(responses.depths_m.size());
  for (std::size_t m = 0; m < responses.methods.size(); ++m) {
    const Templates templates = templates_of(responses, m, variant, level, seconds);
    const Decisions decisions = Observer(templates, normals.for_templates(templates)).decide(sigma);
    out.methods.push_back(
        {.accuracy = decisions.accuracy, .fitted_interval = {}, .error = 0, .shares = decisions.shares});
  }
  return out;
}

/// The prediction with fitted noise, or with `sigma` if that is not 0; from an earlier run if it is kept.
PredictedVariant predict_or_load(const Responses& responses, const PredictedStudy& study, const Interval& interval,
                                 const Variant& variant, std::size_t level, AllNormals& normals,
                                 const std::optional<CacheKey>& kept_as, double sigma) {
  const auto predict_now = [&] {
    return sigma > 0 ? predict_with(sigma, responses, study, variant, level, normals)
                     : predict_variant(responses, study, interval, variant, level, normals);
  };
  if (!kept_as) return predict_now();
  const CacheKey key = key_of(*kept_as, study, variant, level, normals.points(), sigma);
  if (std::optional<PredictedVariant> kept = load_variant(key, responses.methods.size(), responses.shapes.size())) {
    kept->name = variant.name;
    kept->what = variant.what;
    return *std::move(kept);
  }
  PredictedVariant made = predict_now();
  store_variant(key, made);
  return made;
}

/// All errors equally frequent.
PredictedMethod even_errors(double accuracy, std::size_t shapes) {
  PredictedMethod method{.accuracy = accuracy, .fitted_interval = {}, .error = 0, .shares = {}};
  for (std::size_t i = 0; i < shapes * shapes; ++i)
    method.shares.push_back(i % (shapes + 1) == 0 ? accuracy : (1 - accuracy) / static_cast<double>(shapes - 1));
  return method;
}

std::vector<PredictedVariant> null_models(const Responses& responses, const PredictedStudy& study,
                                          const Interval& interval) {
  const std::size_t shapes = responses.shapes.size();
  const auto alternatives = static_cast<std::uint32_t>(shapes);
  PredictedVariant lapses{.name = "lapses",
                          .what = "every shape is felt clearly, but a part of the answers is guessed",
                          .sigma = 1,
                          .methods = {}};
  PredictedVariant equal{.name = "equal distances",
                         .what =
                             "all shapes are equally far apart; of the reference, only the ratio of the methods' "
                             "mean distances is kept",
                         .sigma = 1,
                         .methods = {}};
  const double seconds = study.touch_s / static_cast<double>(responses.depths_m.size());
  std::vector<double> spreads;
  for (std::size_t m = 0; m < responses.methods.size(); ++m)
    spreads.push_back(spread_of(templates_of(responses, m, observer_variants()[0], 0, seconds)));
  for (std::size_t m = 0; m < responses.methods.size(); ++m) {
    lapses.methods.push_back(even_errors(study.fitted.accuracy, shapes));
    lapses.methods.back().fitted_interval = interval;
    const double ratio = spreads[study.fitted.method] > 0 ? spreads[m] / spreads[study.fitted.method] : 0;
    const auto at = [&](double fitted) {
      return study::correct_of_dprime(ratio * study::dprime_of_share(fitted, alternatives), alternatives);
    };
    equal.methods.push_back(even_errors(at(study.fitted.accuracy), shapes));
    equal.methods.back().fitted_interval = Interval{at(interval.low), at(interval.high)};
  }
  return {lapses, equal};
}

std::vector<RankedMethod> ranked(const std::vector<PredictedVariant>& variants, std::size_t methods) {
  std::vector<RankedMethod> ranking;
  for (std::size_t m = 0; m < methods; ++m) {
    RankedMethod entry{.method = m, .accuracy = variants[0].methods[m].accuracy, .low = 1, .high = 0};
    for (const PredictedVariant& variant : variants) {
      if (variant.methods.empty()) continue;
      entry.low = std::min(entry.low, variant.methods[m].accuracy);
      entry.high = std::max(entry.high, variant.methods[m].accuracy);
    }
    ranking.push_back(entry);
  }
  std::ranges::stable_sort(ranking, std::greater<>(), &RankedMethod::accuracy);
  std::size_t best = 0;
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    const auto compare_with_best = [&] {
      std::vector<double> differences;
      for (const PredictedVariant& variant : variants) {
        if (!variant.methods.empty())
          differences.push_back(variant.methods[ranking[best].method].accuracy -
                                variant.methods[ranking[i].method].accuracy);
      }
      ranking[i].to_best = ranking[best].accuracy - ranking[i].accuracy;
      ranking[i].spread = study::standard_deviation(differences).value_or(0);
    };
    compare_with_best();
    // Errors of 0.005 never make a difference.
    if (ranking[i].to_best > std::max(ranking[i].spread, 0.005)) {
      best = i;
      compare_with_best();
    }
    ranking[i].rank = static_cast<std::uint32_t>(best + 1);
  }
  return ranking;
}

/// 95 % of the mean accuracies of simulated studies.
Interval simulated(const PredictedMethod& method, std::size_t shapes, const PredictedStudy& study, std::size_t stream) {
  constexpr std::size_t studies = 2000;
  Random random(study.seed * 0x9e3779b97f4a7c15u + Random(stream).next());
  const std::uint32_t trials = study.observers * study.trials_per_shape;
  std::vector<double> means;
  for (std::size_t i = 0; i < studies; ++i) {
    std::uint32_t correct = 0;
    for (std::size_t shape = 0; shape < shapes; ++shape)
      correct += random.binomial(trials, std::clamp(method.shares[shape * (shapes + 1)], 0.0, 1.0));
    means.push_back(static_cast<double>(correct) / (static_cast<double>(trials) * static_cast<double>(shapes)));
  }
  std::ranges::sort(means);
  return {means[studies / 40], means[studies - 1 - studies / 40]};
}

}  // namespace

Prediction predict(const Responses& responses, const PredictedStudy& study, const ObserverOptions& options) {
  Prediction out{.shapes = responses.shapes,
                 .methods = responses.methods,
                 .depths_m = responses.depths_m,
                 .placements = responses.placements,
                 .study = study,
                 .fitted_interval = {},
                 .variants = {},
                 .levels = {},
                 .reference_force_n = responses.levels[0].force_n,
                 .at_plan = {},
                 .nulls = {},
                 .ranking = {},
                 .studies = {}};
  const FittedNumber& fitted = study.fitted;
  const auto correct = static_cast<std::uint64_t>(std::llround(fitted.accuracy * static_cast<double>(fitted.trials)));
  out.fitted_interval = study::clopper_pearson(correct, fitted.trials);
  const std::size_t linear = responses.levels.size() - 1;
  const std::optional<CacheKey> kept_as = options.keep ? std::optional(key_of(responses)) : std::nullopt;
  Activity activity("decides as the variants of the observer", observer_variants().size() + linear);
  AllNormals normals(options.points);
  const auto predicted = [&](const Variant& variant, std::size_t level, double sigma = 0) {
    PredictedVariant one =
        predict_or_load(responses, study, out.fitted_interval, variant, level, normals, kept_as, sigma);
    activity.advance();
    return one;
  };
  for (const Variant& variant : observer_variants())
    out.variants.push_back(predicted(variant, variant.linear ? linear : 0));
  if (out.variants[0].methods.empty()) {
    throw failure(fmt::format("no internal noise gives {} an accuracy of {}: these touches are too much alike",
                              responses.methods[fitted.method], fitted.accuracy));
  }
  for (std::size_t level = 0; level < responses.levels.size(); ++level) {
    if (responses.levels[level].plan_ceiling) {
      out.at_plan = {responses.levels[level], predicted(observer_variants()[0], level, out.variants[0].sigma)};
      continue;
    }
    PredictedVariant prediction = level == 0 ? out.variants[0] : predicted(observer_variants()[0], level);
    out.levels.push_back({responses.levels[level], std::move(prediction)});
  }
  std::ranges::stable_sort(out.levels, {}, [](const PredictedLevel& level) { return level.level.factor; });
  out.nulls = null_models(responses, study, out.fitted_interval);
  out.ranking = ranked(out.variants, responses.methods.size());
  for (std::size_t m = 0; m < responses.methods.size(); ++m)
    out.studies.push_back(simulated(out.variants[0].methods[m], responses.shapes.size(), study, m));
  return out;
}

}  // namespace palpa::observer
