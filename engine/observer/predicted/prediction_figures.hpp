// The figures of a prediction, as SVG.
#pragma once

#include <string>

#include "observer/comparison.hpp"
#include "observer/prediction.hpp"

namespace palpa::observer {

/// The accuracy of every method with every variant, one row per variant; the results of people as lines.
std::string variants_figure(const Prediction& prediction, const Comparison& comparison);
/// Accuracy by the level of pressure.
std::string levels_figure(const Prediction& prediction);
/// Methods by predicted accuracy, with the range of the variants.
std::string ranking_figure(const Prediction& prediction);

}  // namespace palpa::observer
