#include "observer/predicted/prediction_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "study/pages/svg.hpp"

namespace palpa::observer {
namespace {

using study::Anchor;
using study::Plot;
using study::series;
using study::Svg;

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

}  // namespace

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

}  // namespace palpa::observer
