// A prediction of the ideal observer, with the results of people beside it.
#pragma once

#include <string>

#include "observer/comparison.hpp"
#include "observer/prediction.hpp"

namespace palpa::observer {

/// The text whose SHA-256 identifies a prediction: all that was predicted and all that it depends on, and nothing about
/// people except the fitted number. Numbers have six digits.
std::string prediction_document(const Prediction& prediction);

/// A summary for a terminal. `sha256`: of the document.
std::string prediction_text(const Prediction& prediction, const Comparison& comparison, const std::string& sha256);
/// {"prediction": the document, "sha256": ..., "beside": [...]}.
std::string prediction_json(const Prediction& prediction, const Comparison& comparison, const std::string& sha256);
/// One row per variant and method.
std::string prediction_csv(const Prediction& prediction, const Comparison& comparison);
std::string prediction_html(const Prediction& prediction, const Comparison& comparison, const std::string& sha256);

/// What a prediction does not say, for every report.
std::string prediction_caution();
/// That the interval of the fitted number is too narrow.
std::string interval_caution();
/// How strong the sound of the plan is beside the level to which the noise is fitted; empty without a level of a plan.
std::string plan_level_line(const Prediction& prediction);
/// "single-focus 0.390 (156 of 400 trials)".
std::string fitted_line(const Prediction& prediction);
/// The method's name, and "tied" entries share a rank: "1 cross-section 0.618".
std::string rank_line(const Prediction& prediction, const RankedMethod& entry);

}  // namespace palpa::observer
