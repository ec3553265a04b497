#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "observer/comparison.hpp"
#include "observer/predicted/prediction_reports.hpp"
#include "observer/prediction.hpp"
#include "study/pages/html.hpp"
#include "study/pages/numbers.hpp"
#include "study/pages/svg.hpp"

namespace palpa::observer {
namespace {

using study::Anchor;
using study::Plot;
using study::series;
using study::Svg;

// ---- figures, as SVG

const std::vector<double> accuracy_ticks{0, 0.2, 0.4, 0.6, 0.8, 1};
/// More methods than these would hide each other.
constexpr std::size_t most_drawn = 6;

void draw_method_legend(Svg& svg, double x, double y, const Prediction& prediction) {
  for (std::size_t m = 0; m < std::min(most_drawn, prediction.methods.size()); ++m) {
    const std::string name = shortened(prediction.methods[m], 18);
    svg.marker(x + 6, y - 4, series(m));
    svg.text(x + 16, y, name);
    x += 34 + 7.0 * static_cast<double>(name.size());
  }
}

void draw_chance_upright(Svg& svg, const Plot& plot, double chance) {
  svg.line(plot.x(chance), plot.top, plot.x(chance), plot.top + plot.height, "#a00");
  svg.text(plot.x(chance), plot.top - 4, "chance", Anchor::middle, 11, "#a00");
}

/// The accuracy of every method with every variant, one row per variant; the results of people as lines.
std::string variants_figure(const Prediction& prediction, const Comparison& comparison) {
  std::vector<const PredictedVariant*> rows;
  for (const auto* list : {&prediction.variants, &prediction.nulls}) {
    for (const PredictedVariant& variant : *list)
      rows.push_back(&variant);
  }
  const double row = 20;
  const auto count = static_cast<double>(rows.size());
  Svg svg(760, 110 + row * count, "Predicted accuracy of each method with each variant of the observer");
  const Plot plot{190, 50, 520, row * count, 0, 1, 0, count};
  draw_method_legend(svg, plot.left, 18, prediction);
  draw_x_axis(svg, plot, accuracy_ticks, "accuracy");
  draw_chance_upright(svg, plot, 1 / static_cast<double>(prediction.shapes.size()));
  for (const ObservedMethod& observed : comparison.methods) {
    if (observed.method >= most_drawn) continue;
    const double x = plot.x(accuracy(observed.table));
    svg.curve({{x, plot.top}, {x, plot.top + plot.height}}, series(observed.method));
    svg.text(x, plot.top - 4, "people", Anchor::middle, 11, series(observed.method).colour);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = plot.top + row * (static_cast<double>(i) + 0.5);
    const bool is_null = i >= prediction.variants.size();
    svg.text(plot.left - 8, y + 4, (is_null ? "null: " : "") + rows[i]->name, Anchor::end);
    for (std::size_t m = 0; m < std::min(most_drawn, rows[i]->methods.size()); ++m) {
      const PredictedMethod& method = rows[i]->methods[m];
      if (method.fitted_interval) {
        svg.line(plot.x(method.fitted_interval->low), y, plot.x(method.fitted_interval->high), y, series(m).colour,
                 1.5);
      }
      svg.marker(plot.x(method.accuracy), y, series(m),
                 fmt::format("{}, {}: {:.3f}", rows[i]->name, prediction.methods[m], method.accuracy));
    }
  }
  return svg.finish();
}

/// Accuracy by the level of pressure.
std::string levels_figure(const Prediction& prediction) {
  const std::vector<PredictedLevel>& levels = prediction.levels;
  const double low = std::log10(levels.front().level.force_n), high = std::log10(levels.back().level.force_n);
  Svg svg(560, 330, "Predicted accuracy by the level of pressure");
  const double margin = std::max(0.1, 0.1 * (high - low));
  const Plot plot{60, 40, 460, 230, low - margin, high + margin, 0, 1};
  draw_method_legend(svg, plot.left, 18, prediction);
  draw_y_axis(svg, plot, accuracy_ticks, "accuracy");
  svg.line(plot.left, plot.y(0), plot.left + plot.width, plot.y(0), "#333");
  for (std::size_t i = 0; i < levels.size(); ++i) {
    // Neighbours may be near each other, so their names are not in one line.
    svg.text(plot.x(std::log10(levels[i].level.force_n)), plot.y(0) + (i % 2 == 0 ? 17 : 31), levels[i].level.name,
             Anchor::middle);
  }
  svg.text(plot.left + plot.width / 2, plot.y(0) + 50, "crest of the force of a single focus (linear: not physical)",
           Anchor::middle);
  for (std::size_t m = 0; m < std::min(most_drawn, prediction.methods.size()); ++m) {
    std::vector<std::pair<double, double>> points;
    for (const PredictedLevel& level : levels) {
      if (level.prediction.methods.empty()) continue;
      points.emplace_back(plot.x(std::log10(level.level.force_n)), plot.y(level.prediction.methods[m].accuracy));
    }
    svg.curve(points, series(m));
    for (const auto& [x, y] : points)
      svg.marker(x, y, series(m));
  }
  return svg.finish();
}

/// Methods by predicted accuracy, with the range of the variants.
std::string ranking_figure(const Prediction& prediction) {
  const double row = 26;
  const auto count = static_cast<double>(prediction.ranking.size());
  Svg svg(760, 100 + row * count, "Methods by predicted accuracy");
  const Plot plot{230, 40, 480, row * count, 0, 1, 0, count};
  draw_x_axis(svg, plot, accuracy_ticks, "predicted accuracy");
  draw_chance_upright(svg, plot, 1 / static_cast<double>(prediction.shapes.size()));
  for (std::size_t i = 0; i < prediction.ranking.size(); ++i) {
    const RankedMethod& entry = prediction.ranking[i];
    const double y = plot.top + row * (static_cast<double>(i) + 0.5);
    svg.text(plot.left - 8, y + 4, fmt::format("{}. {}", entry.rank, shortened(prediction.methods[entry.method], 24)),
             Anchor::end);
    svg.line(plot.x(entry.low), y, plot.x(entry.high), y, "#888", 2);
    // Ranks alternate in their look, so that ties show.
    svg.marker(plot.x(entry.accuracy), y, series(entry.rank % 2), fmt::format("{:.3f}", entry.accuracy));
  }
  return svg.finish();
}

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
