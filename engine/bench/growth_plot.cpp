#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/growth.hpp"
#include "study/pages/svg.hpp"

namespace palpa::bench {
namespace {

constexpr double panel_width = 230, panel_height = 190, left = 52, top = 58, between_x = 60, between_y = 66;
constexpr std::size_t columns = 4;

/// 10 ms, 100 kB and so on, without the zeros.
std::string short_number(int power) {
  static constexpr const char* ends[]{"", "k", "M"};
  if (power < 0) return fmt::format("{:.{}f}", std::pow(10, power), -power);
  return fmt::format("{:.0f}{}", std::pow(10, power % 3), ends[std::min(power / 3, 2)]);
}

/// Whole powers of ten around all values.
struct Decades {
  int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();
  void include(double value) {
    low = std::min(low, static_cast<int>(std::floor(std::log10(value) + 1e-9)));
    high = std::max({high, low + 1, static_cast<int>(std::ceil(std::log10(value) - 1e-9))});
  }
};

void draw_axes(study::Svg& svg, const study::Plot& plot, bool first) {
  for (int power = static_cast<int>(plot.y_low); power <= static_cast<int>(plot.y_high); ++power) {
    svg.line(plot.left, plot.y(power), plot.left + plot.width, plot.y(power), "#ddd");
    svg.text(plot.left - 5, plot.y(power) + 4, short_number(power) + (first ? " ms" : ""), study::Anchor::end, 11);
  }
  for (int power = static_cast<int>(plot.x_low); power <= static_cast<int>(plot.x_high); ++power) {
    svg.line(plot.x(power), plot.top, plot.x(power), plot.top + plot.height, "#ddd");
    svg.text(plot.x(power), plot.top + plot.height + 15, short_number(power), study::Anchor::middle, 11);
  }
}

/// Lines of exponent 1 through the panel, for comparison.
void draw_linear(study::Svg& svg, const study::Plot& plot) {
  for (int power = static_cast<int>(plot.y_low - (plot.x_high - plot.x_low)); power < plot.y_high; ++power) {
    const double x_begin = plot.x_low + std::max(0.0, plot.y_low - power);
    const double x_end = plot.x_low + std::min(plot.x_high - plot.x_low, plot.y_high - power);
    if (x_end <= x_begin) continue;
    svg.line(plot.x(x_begin), plot.y(power + x_begin - plot.x_low), plot.x(x_end), plot.y(power + x_end - plot.x_low),
             "#ccc", 0.6);
  }
}

void draw_curve(study::Svg& svg, const study::Plot& plot, const GrowthCurve& curve, std::size_t number) {
  const study::Series look = study::series(number);
  std::vector<std::pair<double, double>> places;
  for (const GrowthSample& sample : curve.samples)
    places.emplace_back(plot.x(std::log10(sample.size)), plot.y(std::log10(sample.ms)));
  svg.curve(places, look);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const GrowthSample& sample = curve.samples[i];
    svg.marker(places[i].first, places[i].second, look,
               fmt::format("{:.0f} {}: {:.2f} ms, {}", sample.size, curve.name, sample.ms, curve.where));
  }
}

/// The fitted exponents, in a field without a curve.
void draw_exponents(study::Svg& svg, double x, double y, std::span<const GrowthCurve> curves) {
  constexpr double line = 19, column = 60;
  svg.text(x, y - 8, "exponents", study::Anchor::start, 13);
  std::vector<std::string> names;
  for (const GrowthCurve& curve : curves) {
    const bool first = names.empty() || names.back() != curve.name;
    if (first) names.push_back(curve.name);
    const double at_y = y + line * static_cast<double>(names.size() + 1);
    if (first) svg.text(x, at_y, curve.name);
    svg.text(x + 2 * column + (first ? 0 : column), at_y, fmt::format("{:.2f}", exponents_of(curve.samples).fitted),
             study::Anchor::end);
  }
  for (const std::size_t where : {0, 1})
    svg.marker(x + column * static_cast<double>(2 + where) - 12, y + line - 8, study::series(where));
}

}  // namespace

std::string growth_svg(std::span<const GrowthCurve> curves, const std::string& device) {
  std::vector<std::string> names;
  Decades times;
  for (const GrowthCurve& curve : curves) {
    if (std::find(names.begin(), names.end(), curve.name) == names.end()) names.push_back(curve.name);
    for (const GrowthSample& sample : curve.samples)
      times.include(sample.ms);
  }
  const auto rows = static_cast<double>((names.size() + columns - 1) / columns);
  const double step_x = panel_width + between_x, step_y = panel_height + between_y;
  const double width = columns * step_x + 14, height = top - 20 + rows * step_y;
  study::Svg svg(width, height, "The time of a frame against the size of what it is about");
  svg.rectangle(0, 0, width, height, "#fff");
  for (const std::size_t where : {0, 1}) {
    const double x = left + 70.0 * static_cast<double>(where);
    svg.marker(x, 18, study::series(where));
    svg.text(x + 10, 22, where == 0 ? "host" : device);
  }
  svg.text(width - 15, 22, "grey diagonals: linear", study::Anchor::end, 12, "#777");
  for (std::size_t i = 0; i < names.size(); ++i) {
    Decades sizes;
    for (const GrowthCurve& curve : curves) {
      if (curve.name != names[i]) continue;
      for (const GrowthSample& sample : curve.samples)
        sizes.include(sample.size);
    }
    const study::Plot plot{left + step_x * static_cast<double>(i % columns),
                           top + step_y * static_cast<double>(i / columns),
                           panel_width,
                           panel_height,
                           static_cast<double>(sizes.low),
                           static_cast<double>(sizes.high),
                           static_cast<double>(times.low),
                           static_cast<double>(times.high)};
    draw_linear(svg, plot);
    draw_axes(svg, plot, i % columns == 0);
    svg.text(plot.left, plot.top - 8, names[i], study::Anchor::start, 13);
    std::size_t number = 0;
    for (const GrowthCurve& curve : curves) {
      if (curve.name == names[i]) draw_curve(svg, plot, curve, number++);
    }
  }
  if (const std::size_t last = names.size(); last % columns != 0) {
    draw_exponents(svg, left + step_x * static_cast<double>(last % columns),
                   top + step_y * static_cast<double>(last / columns), curves);
  }
  return svg.finish();
}

}  // namespace palpa::bench
