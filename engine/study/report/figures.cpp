#include "study/report/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/text.hpp"
#include "study/pages/svg.hpp"

namespace palpa::study {
namespace {

const std::vector<double> share_ticks{0, 0.2, 0.4, 0.6, 0.8, 1};

enum class Sample { bar, line, marked_line };

/// The names of series in a row above a plot, each with a sample of its look.
void draw_legend(Svg& svg, double x, double y, const std::vector<std::string>& names, Sample sample) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (sample == Sample::bar) {
      svg.rectangle(x + 10, y - 10, 14, 11, series(i).colour);
    } else {
      svg.curve({{x, y - 4}, {x + 26, y - 4}}, series(i));
    }
    if (sample == Sample::marked_line) svg.marker(x + 13, y - 4, series(i));
    svg.text(x + 31, y, names[i]);
    x += 48 + 7.0 * static_cast<double>(names[i].size());
  }
}

void draw_chance(Svg& svg, const Plot& plot, double chance) {
  svg.line(plot.left, plot.y(chance), plot.left + plot.width, plot.y(chance), "#a00", 1);
  svg.text(plot.left + plot.width + 4, plot.y(chance) + 4, "chance", Anchor::start, 11, "#a00");
}

/// From white to dark blue; lightness alone tells the shades apart.
std::string shade(double share) {
  const auto part = [&](double light, double dark) {
    return static_cast<int>(std::lround(light + (dark - light) * share));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", part(255, 8), part(255, 48), part(255, 107));
}

std::string brief(const std::string& name) {
  return shortened(name, 14);
}

/// About five steps of 1, 2 or 5 times a power of ten.
std::vector<double> even_ticks(double high) {
  const double wanted = high / 5, power = std::pow(10, std::floor(std::log10(wanted)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= wanted * (1 - 1e-9)) step = factor * power;
  }
  std::vector<double> ticks;
  for (int i = 0; i * step <= high * (1 + 1e-9); ++i)
    ticks.push_back(i * step);
  return ticks;
}

}  // namespace

std::string accuracy_figure(const Analysis& analysis) {
  const auto people = static_cast<double>(analysis.study.participants.size());
  const std::size_t methods = analysis.study.methods.size();
  // One group of bars per participant, and one for the means. Groups are narrower if there are many participants.
  const double group = std::clamp(740 / people, 7.0, 70.0), means = std::max(group, 60.0), gap = 30;
  const double inside = group * people + gap + means;
  Svg svg(56 + inside + 60, 330,
          "Accuracy of each participant with each method, and the means with standard deviations");
  const Plot plot{56, 34, inside, 240, 0, inside, 0, 1};
  draw_y_axis(svg, plot, share_ticks, "accuracy");
  draw_legend(svg, plot.left, 18, analysis.study.methods, Sample::bar);
  // Returns the middle of the bar.
  const auto draw_bar = [&](double begin, double width, std::size_t m, double value, const std::string& tip) {
    const double bar = 0.8 * width / static_cast<double>(methods);
    const double x = plot.x(begin + 0.1 * width) + bar * static_cast<double>(m);
    svg.rectangle(x, plot.y(value), bar, plot.y(0) - plot.y(value), series(m).colour, tip);
    return x + bar / 2;
  };
  for (const PersonResult& result : analysis.results.people) {
    draw_bar(group * static_cast<double>(result.person), group, result.method, result.accuracy,
             fmt::format("participant {}, {}: {:.3f}", analysis.study.participants[result.person].number,
                         analysis.study.methods[result.method], result.accuracy));
  }
  for (std::size_t m = 0; m < methods; ++m) {
    const MethodResult& method = analysis.results.methods[m];
    const double x = draw_bar(inside - means, means, m, method.mean_accuracy,
                              fmt::format("mean, {}: {:.3f}", method.pooled.name, method.mean_accuracy));
    if (!method.deviation) continue;
    svg.whisker(x, plot.y(std::min(1.0, method.mean_accuracy + *method.deviation)),
                plot.y(std::max(0.0, method.mean_accuracy - *method.deviation)));
  }
  draw_chance(svg, plot, 1 / static_cast<double>(analysis.study.shapes.size()));
  svg.line(plot.left, plot.y(0), plot.left + plot.width, plot.y(0), "#333");
  const auto every = static_cast<std::size_t>(std::ceil(28 / group));
  for (std::size_t i = 0; i < analysis.study.participants.size(); i += every) {
    svg.text(plot.x(group * (static_cast<double>(i) + 0.5)), plot.y(0) + 17,
             std::to_string(analysis.study.participants[i].number), Anchor::middle);
  }
  svg.text(plot.x(inside - means / 2), plot.y(0) + 17, "mean", Anchor::middle);
  svg.text(plot.x(group * people / 2), plot.y(0) + 38, "participant", Anchor::middle);
  return svg.finish();
}

std::string confusion_figure(const Measures& measures) {
  const Confusion& table = measures.table;
  const auto m = static_cast<double>(table.size());
  const double cell = std::clamp(420 / m, 26.0, 74.0), left = 130, top = 62;
  Svg svg(left + cell * m + 12, top + cell * m + 12, "Confusion matrix of " + measures.name);
  std::size_t longest = 0;
  for (const std::string& shape : table.shapes)
    longest = std::max(longest, brief(shape).size());
  // Long names of neighbouring columns would touch each other in one line.
  const bool staggered = 7 * static_cast<double>(longest) > cell;
  svg.text(left + cell * m / 2, 18, "answer", Anchor::middle);
  svg.text_upward(16, top + cell * m / 2, "actual shape");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double y = top + cell * static_cast<double>(i);
    svg.text(left - 8, y + cell / 2 + 4, brief(table.shapes[i]), Anchor::end);
    const double column = left + cell * (static_cast<double>(i) + 0.5);
    svg.text(column, staggered && i % 2 == 1 ? top - 23 : top - 8, brief(table.shapes[i]), Anchor::middle);
    for (std::size_t j = 0; j < table.size(); ++j) {
      const double x = left + cell * static_cast<double>(j), value = share(table, i, j).value_or(0);
      svg.rectangle(
          x, y, cell, cell, shade(value),
          fmt::format("{} answered as {}: {} of {}", table.shapes[i], table.shapes[j], table.at(i, j), table.row(i)));
      if (cell < 32) continue;
      svg.text(x + cell / 2, y + cell / 2 + 4, fmt::format("{:.2f}", value), Anchor::middle, 13,
               value > 0.65 ? "#fff" : "#111");
    }
  }
  return svg.finish();
}

std::string learning_figure(const Analysis& analysis) {
  Svg svg(550, 300, "Mean accuracy in each quarter of the trials");
  const Plot plot{56, 34, 440, 214, 0.5, blocks + 0.5, 0, 1};
  draw_y_axis(svg, plot, share_ticks, "accuracy");
  std::vector<double> ticks;
  for (std::size_t b = 1; b <= blocks; ++b)
    ticks.push_back(static_cast<double>(b));
  draw_x_axis(svg, plot, ticks, "quarter of the trials");
  draw_legend(svg, plot.left, 18, analysis.study.methods, Sample::marked_line);
  draw_chance(svg, plot, 1 / static_cast<double>(analysis.study.shapes.size()));
  for (std::size_t m = 0; m < analysis.courses.size(); ++m) {
    const std::vector<double>& accuracies = analysis.courses[m].learning.block_accuracy;
    std::vector<std::pair<double, double>> points;
    for (std::size_t b = 0; b < accuracies.size(); ++b)
      points.emplace_back(plot.x(static_cast<double>(b + 1)), plot.y(accuracies[b]));
    if (points.empty()) continue;
    svg.curve(points, series(m));
    for (std::size_t b = 0; b < points.size(); ++b) {
      svg.marker(points[b].first, points[b].second, series(m),
                 fmt::format("{}, quarter {}: {:.3f}", analysis.study.methods[m], b + 1, accuracies[b]));
    }
  }
  return svg.finish();
}

std::string depth_figure(const Analysis& analysis, std::size_t method) {
  const std::vector<MeanDepth>& depths = analysis.courses[method].depths;
  double longest = 1, deepest = 1, highest = 0;
  for (const MeanDepth& depth : depths) {
    longest = std::max(longest, DepthCourse::bin_s * static_cast<double>(depth.depth_m.size()));
    for (const std::optional<double>& value : depth.depth_m) {
      deepest = std::max(deepest, 1e3 * value.value_or(0));
      highest = std::min(highest, 1e3 * value.value_or(0));
    }
  }
  Svg svg(620, 300, "Mean depth of the finger in a trial with " + analysis.study.methods[method]);
  const Plot plot{56, 34, 540, 214, 0, longest, deepest * 1.05, highest * 1.05};  // deeper is lower
  draw_y_axis(svg, plot, even_ticks(deepest), "depth (mm)");
  draw_x_axis(svg, plot, even_ticks(longest), "time in the trial (s)");
  draw_legend(svg, plot.left, 18, analysis.study.shapes, Sample::line);
  for (std::size_t shape = 0; shape < depths.size(); ++shape) {
    std::vector<std::pair<double, double>> points;
    for (std::size_t bin = 0; bin < depths[shape].depth_m.size(); ++bin) {
      if (const auto& value = depths[shape].depth_m[bin])
        points.emplace_back(plot.x(DepthCourse::bin_s * (static_cast<double>(bin) + 0.5)), plot.y(1e3 * *value));
    }
    if (!points.empty()) svg.curve(points, series(shape));
  }
  return svg.finish();
}

std::string comparison_figure(const std::vector<Measures>& tables) {
  const double row = 30, left = 330, height = row * static_cast<double>(tables.size());
  Svg svg(left + 420, height + 74, "Accuracies with 95 % intervals");
  const Plot plot{left, 14, 390, height, 0, 1, 1, 0};
  for (const double tick : share_ticks)
    svg.line(plot.x(tick), plot.top, plot.x(tick), plot.top + plot.height, "#ddd");
  draw_x_axis(svg, plot, share_ticks, "accuracy");
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const double y = plot.top + row * (static_cast<double>(i) + 0.5);
    const std::string& name = tables[i].name;
    svg.text(left - 10, y + 4, shortened(name, 46), Anchor::end);
    svg.line(plot.x(tables[i].clopper_pearson.low), y, plot.x(tables[i].clopper_pearson.high), y, "#111", 1.6);
    svg.marker(plot.x(tables[i].accuracy), y, series(i), fmt::format("{}: {:.4f}", name, tables[i].accuracy));
  }
  return svg.finish();
}

std::string power_figure(const PowerSetting& setting, const PowerResult& result) {
  Svg svg(560, 300, "Power by number of participants");
  const double most = result.rows.empty() ? 2 : result.rows.back().people;
  const Plot plot{56, 34, 480, 214, 0, most + 1, 0, 1};
  draw_y_axis(svg, plot, share_ticks, "power");
  draw_x_axis(svg, plot, even_ticks(most), "participants");
  svg.line(plot.left, plot.y(setting.power), plot.left + plot.width, plot.y(setting.power), "#a00");
  std::vector<std::pair<double, double>> points;
  for (const PowerRow& row : result.rows) {
    svg.whisker(plot.x(row.people), plot.y(row.interval.high), plot.y(row.interval.low));
    points.emplace_back(plot.x(row.people), plot.y(row.power));
  }
  svg.curve(points, series(1));
  for (const PowerRow& row : result.rows)
    svg.marker(plot.x(row.people), plot.y(row.power), series(1), fmt::format("{}: {:.3f}", row.people, row.power));
  return svg.finish();
}

}  // namespace palpa::study
