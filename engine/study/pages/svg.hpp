// Drawings as SVG text, with the colours and the axes that all figures of a report share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpa::study {

/// `text` with the characters escaped that mean something in HTML and SVG, and with unprintable characters as in
/// messages.
std::string escaped(std::string_view text);

/// The look of the n-th of several series. Colours are those of Okabe and Ito, which colour-blind people can tell
/// apart. In print without colours, they differ in lightness and in their dashes and markers.
struct Series {
  const char* colour;
  const char* dashes;  ///< of lines, as SVG's stroke-dasharray
  char marker;         ///< 'o', 's' (square), 't' (triangle) or 'd' (diamond)
};
Series series(std::size_t n);

enum class Anchor { start, middle, end };

class Svg {
 public:
  /// Size in pixels of CSS; `label` describes the drawing for people who cannot see it.
  Svg(double width, double height, std::string_view label);

  void rectangle(double x, double y, double width, double height, std::string_view fill, std::string_view tip = {});
  void line(double x1, double y1, double x2, double y2, std::string_view colour = "#555", double width = 1);
  /// Points that a line joins.
  void curve(const std::vector<std::pair<double, double>>& points, const Series& look);
  void marker(double x, double y, const Series& look, std::string_view tip = {});
  void text(double x, double y, std::string_view words, Anchor anchor = Anchor::start, double size = 12,
            std::string_view colour = "#111");
  /// Reads upward.
  void text_upward(double x, double y, std::string_view words);
  /// A vertical bar with ends, for a spread or an interval.
  void whisker(double x, double y1, double y2);

  /// The whole drawing.
  std::string finish();

 private:
  std::string text_;
};

/// The frame of a chart: a rectangle of the drawing in which x and y have scales.
struct Plot {
  double left, top, width, height;
  double x_low, x_high, y_low, y_high;

  double x(double value) const { return left + width * (value - x_low) / (x_high - x_low); }
  double y(double value) const { return top + height * (y_high - value) / (y_high - y_low); }
};
/// Axis lines, ticks with numbers, grid lines and the axes' names. `ticks` are values.
void draw_y_axis(Svg& svg, const Plot& plot, const std::vector<double>& ticks, std::string_view name);
void draw_x_axis(Svg& svg, const Plot& plot, const std::vector<double>& ticks, std::string_view name);

}  // namespace palpa::study
