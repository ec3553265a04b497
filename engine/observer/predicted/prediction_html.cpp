#include <fmt/format.h>

#include <optional>
#include <vector>

#include "observer/predicted/prediction_figures.hpp"
#include "observer/predicted/prediction_reports.hpp"
#include "study/pages/html.hpp"
#include "study/pages/numbers.hpp"

namespace palpa::observer {
namespace {

using study::Confusion;
using study::HtmlPage;
using study::HtmlRow;
using study::Interval;
using study::shown;

/// A table of shares; with counts of people beside them if there are any.
std::vector<HtmlRow> table_of(const std::vector<std::string>& shapes, const std::vector<double>& shares,
                              const Confusion* people) {
  std::vector<HtmlRow> rows{{"actual shape"}};
  rows[0].insert(rows[0].end(), shapes.begin(), shapes.end());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    rows.push_back({shapes[i]});
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      std::string cell = fmt::format("{:.2f}", shares[i * shapes.size() + j]);
      if (people) cell += fmt::format(" ({:.2f})", share(*people, i, j).value_or(0));
      rows.back().push_back(std::move(cell));
    }
  }
  return rows;
}

void add_variants(HtmlPage& page, const Prediction& p) {
  std::vector<HtmlRow> rows{{"variant", "what it is"}};
  for (const std::string& method : p.methods)
    rows[0].push_back(method);
  const auto add = [&](const std::string& name, const PredictedVariant& variant) {
    rows.push_back({name, variant.what});
    for (std::size_t m = 0; m < p.methods.size(); ++m) {
      if (variant.methods.empty()) {
        rows.back().emplace_back(study::no_value);
        continue;
      }
      const PredictedMethod& method = variant.methods[m];
      rows.back().push_back(fmt::format("{} ({})", shown(method.accuracy), shown(method.fitted_interval)));
    }
  };
  for (const PredictedVariant& variant : p.variants)
    add(variant.name, variant);
  for (const PredictedLevel& level : p.levels)
    add("level " + level.level.name, level.prediction);
  if (p.at_plan) add("level " + p.at_plan->level.name + ", noise of the reference", p.at_plan->prediction);
  for (const PredictedVariant& null : p.nulls)
    add("null: " + null.name, null);
  page.table(
      "Accuracies, and in brackets those for a fitted number at the ends of its 95 % interval. A variant without "
      "values cannot reach the fitted number.",
      rows);
}

void add_fits(HtmlPage& page, const Prediction& p, const ObservedMethod& o) {
  std::vector<HtmlRow> rows{{"prediction", "rms", "correlation of the errors", "log likelihood per trial"}};
  const auto add = [&](const std::string& name, const TableFit& fit) {
    rows.push_back({name, shown(fit.rms), shown(fit.errors_r), shown(fit.log_likelihood)});
  };
  for (std::size_t v = 0; v < p.variants.size(); ++v) {
    if (!p.variants[v].methods.empty()) add(p.variants[v].name, o.variants[v]);
  }
  for (std::size_t n = 0; n < p.nulls.size(); ++n)
    add("null: " + p.nulls[n].name, o.nulls[n]);
  add("chance", o.chance);
  add("the table itself", o.itself);
  page.table(
      fmt::format("Predicted tables beside that of people ({}, {}). A perfect prediction would have an rms of {} and "
                  "a correlation of {}, because the table has few trials.",
                  p.methods[o.method], o.source, shown(o.ceiling_rms), shown(o.ceiling_r)),
      rows);
}

}  // namespace

std::string prediction_html(const Prediction& p, const Comparison& comparison, const std::string& sha256) {
  HtmlPage page("Which shape will it be? The prediction of an ideal observer");
  page.paragraph(prediction_caution());
  page.paragraph(interval_caution());
  if (p.at_plan) page.paragraph(plan_level_line(p));
  page.paragraph(fmt::format("Fitted to {}. {} shapes, {} depths, {} placements. SHA-256 of the prediction: {}.",
                             fitted_line(p), p.shapes.size(), p.depths_m.size(), p.placements, sha256));
  if (!comparison.left_out.empty()) {
    page.paragraph("Not everything could be put beside it:");
    page.list(comparison.left_out);
  }
  page.heading("Accuracies");
  page.figure(
      variants_figure(p, comparison),
      "Each row is an observer. Lines through the markers: accuracies for a fitted number at the ends of its 95 % "
      "interval. Upright lines: chance, and people.");
  add_variants(page, p);
  page.heading("Level of pressure");
  page.figure(levels_figure(p), "The reference observer at other levels of pressure, each fitted to the same number.");
  page.heading("Answers");
  for (std::size_t m = 0; m < p.methods.size(); ++m) {
    const Confusion* people = nullptr;
    for (const ObservedMethod& observed : comparison.methods) {
      if (observed.method == m) people = &observed.table;
    }
    page.table(
        fmt::format("{}: predicted shares of the answers{}", p.methods[m], people ? " (in brackets: people)" : ""),
        table_of(p.shapes, p.variants[0].methods[m].shares, people));
  }
  if (!comparison.methods.empty()) page.heading("Beside people");
  for (const ObservedMethod& observed : comparison.methods)
    add_fits(page, p, observed);
  page.heading("What should the next study try?");
  page.figure(ranking_figure(p),
              "Methods by predicted accuracy. Bars: the range over all variants. Methods with the same rank are tied.");
  std::vector<HtmlRow> rows{{"method", "rank", "accuracy", "variants", "behind the first of its rank", "spread",
                             fmt::format("studies of {} people", p.study.observers)}};
  for (const RankedMethod& entry : p.ranking) {
    rows.push_back({p.methods[entry.method], std::to_string(entry.rank), shown(entry.accuracy),
                    shown(std::optional(Interval{entry.low, entry.high})), shown(entry.to_best), shown(entry.spread),
                    shown(std::optional(p.studies[entry.method]))});
  }
  page.table(
      "Ranks. Spread: the standard deviation over the variants of the difference to the first of the rank. A smaller "
      "difference is a tie. Last column: 95 % of the mean accuracies of simulated studies.",
      rows);
  return page.finish();
}

}  // namespace palpa::observer
