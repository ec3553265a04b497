#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "base/text.hpp"
#include "observer/predicted/prediction_reports.hpp"
#include "study/pages/numbers.hpp"

namespace palpa::observer {
namespace {

using study::name_cell;
using study::number_cell;
using study::shown;

std::string accuracies(const PredictedVariant& variant, std::size_t methods) {
  std::string text;
  for (std::size_t m = 0; m < methods; ++m)
    text += variant.methods.empty() ? "            -" : fmt::format("{:>13}", shown(variant.methods[m].accuracy));
  return text;
}

void add_table(std::string& text, const std::string& name, const std::vector<std::string>& shapes,
               const std::vector<double>& shares) {
  fmt::format_to(std::back_inserter(text), "\n{}, answers in columns:\n", printable(name));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "  {:<14}", shortened(printable(shapes[i]), 14));
    for (std::size_t j = 0; j < shapes.size(); ++j)
      fmt::format_to(std::back_inserter(text), "{:>7.2f}", shares[i * shapes.size() + j]);
    text += '\n';
  }
}

}  // namespace

std::string prediction_caution() {
  return "An ideal observer with one fitted number: it predicts the order of methods better than their accuracies, and "
         "its confusions of shapes are not those of people.";
}

std::string interval_caution() {
  return "The interval of the fitted number takes all trials as independent. Those of one person are not, so it is too "
         "narrow, and so are the intervals that follow from it.";
}

std::string plan_level_line(const Prediction& p) {
  if (!p.at_plan) return {};
  const double crest_n = p.at_plan->level.force_n, reference_n = p.reference_force_n;
  std::string line = fmt::format("At the plan's ceiling of {:g}, the force at a single focus' crest is {:.2g} mN",
                                 p.at_plan->level.plan_ceiling.value_or(1), crest_n * 1e3);
  if (crest_n < 0.99 * reference_n) {
    line += fmt::format(
        ", {:.0f} times less than the {:g} mN to which the noise is fitted. With that noise, the predictions are those "
        "of "
        "the level 'plan'; it may not be felt at all",
        reference_n / crest_n, reference_n * 1e3);
  }
  return line + ".";
}

std::string fitted_line(const Prediction& prediction) {
  const FittedNumber& fitted = prediction.study.fitted;
  return fmt::format("{} {} ({} of {} trials, 95 % {})", printable(prediction.methods[fitted.method]),
                     shown(fitted.accuracy), std::llround(fitted.accuracy * static_cast<double>(fitted.trials)),
                     fitted.trials, shown(std::optional(prediction.fitted_interval)));
}

std::string rank_line(const Prediction& prediction, const RankedMethod& entry) {
  return fmt::format("{:>3}  {:<24}{}   variants {} to {}", entry.rank,
                     shortened(printable(prediction.methods[entry.method]), 23), shown(entry.accuracy),
                     shown(entry.low), shown(entry.high));
}

std::string prediction_text(const Prediction& p, const Comparison& comparison, const std::string& sha256) {
  std::string text;
  const auto out = std::back_inserter(text);
  const std::size_t methods = p.methods.size();
  fmt::format_to(out, "{} shapes, {} methods, {} depths, {} placements; fitted to {}\n", p.shapes.size(), methods,
                 p.depths_m.size(), p.placements, fitted_line(p));
  fmt::format_to(out, "\n  {:<22}", "accuracy");
  for (const std::string& method : p.methods)
    fmt::format_to(out, "{:>13}", shortened(printable(method), 12));
  text += '\n';
  const PredictedVariant& reference = p.variants[0];
  for (const PredictedVariant& variant : p.variants)
    fmt::format_to(out, "  {:<22}{}\n", variant.name, accuracies(variant, methods));
  for (const PredictedLevel& level : p.levels)
    fmt::format_to(out, "  {:<22}{}\n", "level " + level.level.name, accuracies(level.prediction, methods));
  if (p.at_plan)
    fmt::format_to(out, "  {:<22}{}\n", "level " + p.at_plan->level.name, accuracies(p.at_plan->prediction, methods));
  for (const PredictedVariant& null : p.nulls)
    fmt::format_to(out, "  {:<22}{}\n", "null: " + null.name, accuracies(null, methods));
  for (const ObservedMethod& observed : comparison.methods) {
    fmt::format_to(out, "  people, {}: {} {}\n", printable(observed.source), printable(p.methods[observed.method]),
                   shown(accuracy(observed.table)));
  }
  text += '\n';
  for (std::size_t m = 0; m < methods; ++m) {
    if (m == p.study.fitted.method) continue;
    const PredictedMethod& method = reference.methods[m];
    fmt::format_to(out,
                   "{}: {}; {} if the fitted number is at the ends of its interval; numerical error {:.4f}; "
                   "studies of {} people {}\n",
                   printable(p.methods[m]), shown(method.accuracy), shown(method.fitted_interval), method.error,
                   p.study.observers, shown(std::optional(p.studies[m])));
  }
  for (std::size_t m = 0; m < methods; ++m)
    add_table(text, p.methods[m], p.shapes, reference.methods[m].shares);
  for (const ObservedMethod& o : comparison.methods) {
    const TableFit& fit = o.variants[0];
    fmt::format_to(out,
                   "\n{} beside {}: rms {} (chance {}, a perfect prediction {}), correlation of the errors {} (at most "
                   "{}), log likelihood per trial {} (chance {}, the table itself {})\n",
                   printable(p.methods[o.method]), printable(o.source), shown(fit.rms), shown(o.chance.rms),
                   shown(o.ceiling_rms), shown(fit.errors_r), shown(o.ceiling_r), shown(fit.log_likelihood),
                   shown(o.chance.log_likelihood), shown(o.itself.log_likelihood));
  }
  text += "\nRanking; methods of one rank are tied, because the variants differ more than they do:\n";
  for (const RankedMethod& entry : p.ranking)
    text += rank_line(p, entry) + "\n";
  text += "\nsha256 of the prediction: " + sha256 + "\n" + prediction_caution() + "\n" + interval_caution() + "\n";
  return p.at_plan ? text + plan_level_line(p) + "\n" : text;
}

std::string prediction_csv(const Prediction& p, const Comparison& comparison) {
  std::string csv = "kind,variant,method,accuracy,low,high,error,rms,errors_r,log_likelihood\n";
  const auto add = [&](const char* kind, const PredictedVariant& variant, const std::string& name, std::size_t index,
                       const std::vector<TableFit> ObservedMethod::*fits) {
    for (std::size_t m = 0; m < variant.methods.size(); ++m) {
      const PredictedMethod& method = variant.methods[m];
      fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},", kind, name_cell(name), name_cell(p.methods[m]),
                     number_cell(method.accuracy),
                     number_cell(method.fitted_interval ? std::optional(method.fitted_interval->low) : std::nullopt),
                     number_cell(method.fitted_interval ? std::optional(method.fitted_interval->high) : std::nullopt),
                     number_cell(method.error));
      const auto found = std::ranges::find(comparison.methods, m, &ObservedMethod::method);
      if (fits == nullptr || found == comparison.methods.end()) {
        csv += ",,\n";
        continue;
      }
      const TableFit& fit = ((*found).*fits)[index];
      fmt::format_to(std::back_inserter(csv), "{},{},{}\n", number_cell(fit.rms), number_cell(fit.errors_r),
                     number_cell(fit.log_likelihood));
    }
  };
  for (std::size_t v = 0; v < p.variants.size(); ++v)
    add("variant", p.variants[v], p.variants[v].name, v, &ObservedMethod::variants);
  for (const PredictedLevel& level : p.levels)
    add("level", level.prediction, level.level.name, 0, nullptr);
  if (p.at_plan) add("plan level", p.at_plan->prediction, p.at_plan->level.name, 0, nullptr);
  for (std::size_t n = 0; n < p.nulls.size(); ++n)
    add("null", p.nulls[n], p.nulls[n].name, n, &ObservedMethod::nulls);
  return csv;
}

}  // namespace palpa::observer
