#include "study/pages/svg.hpp"

#include <fmt/format.h>

#include <iterator>

#include "base/text.hpp"

namespace palpa::study {
namespace {

/// A place in the drawing: two decimals are a hundredth of a pixel.
std::string at(double value) {
  std::string text = fmt::format("{:.2f}", value);
  return text == "-0.00" ? "0.00" : text;
}

std::string tip_of(std::string_view tip) {
  return tip.empty() ? std::string() : fmt::format("<title>{}</title>", escaped(tip));
}

const char* word_of(Anchor anchor) {
  return anchor == Anchor::start ? "start" : anchor == Anchor::middle ? "middle" : "end";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : printable(text)) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

Series series(std::size_t n) {
  static constexpr Series looks[]{{"#e69f00", "none", 'o'},    {"#0072b2", "7 3", 's'},    {"#009e73", "2 3", 't'},
                                  {"#d55e00", "9 3 2 3", 'd'}, {"#56b4e9", "none", 's'},   {"#cc79a7", "7 3", 't'},
                                  {"#333333", "2 3", 'd'},     {"#999933", "9 3 2 3", 'o'}};
  return looks[n % std::size(looks)];
}

Svg::Svg(double width, double height, std::string_view label)
    : text_(fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
                        "height=\"{1}\" role=\"img\" aria-label=\"{2}\" font-family=\"sans-serif\">\n",
                        at(width), at(height), escaped(label))) {}

void Svg::rectangle(double x, double y, double width, double height, std::string_view fill, std::string_view tip) {
  text_ += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#333\" "
      "stroke-width=\"0.6\">{}</rect>\n",
      at(x), at(y), at(width), at(height), fill, tip_of(tip));
}

void Svg::line(double x1, double y1, double x2, double y2, std::string_view colour, double width) {
  text_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", at(x1),
                       at(y1), at(x2), at(y2), colour, width);
}

void Svg::curve(const std::vector<std::pair<double, double>>& points, const Series& look) {
  std::string places;
  for (const auto& [x, y] : points)
    places += fmt::format("{}{},{}", places.empty() ? "" : " ", at(x), at(y));
  text_ += fmt::format(
      "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" "
      "stroke-dasharray=\"{}\"/>\n",
      places, look.colour, look.dashes);
}

void Svg::marker(double x, double y, const Series& look, std::string_view tip) {
  constexpr double r = 4;
  std::vector<std::pair<double, double>> corners;
  if (look.marker == 's') {
    corners = {{-r, -r}, {r, -r}, {r, r}, {-r, r}};
  } else if (look.marker == 't') {
    corners = {{0, -r * 1.2}, {r * 1.1, r}, {-r * 1.1, r}};
  } else if (look.marker == 'd') {
    corners = {{0, -r * 1.3}, {r * 1.3, 0}, {0, r * 1.3}, {-r * 1.3, 0}};
  }
  if (corners.empty()) {
    text_ += fmt::format(
        "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" stroke=\"#333\" "
        "stroke-width=\"0.6\">{}</circle>\n",
        at(x), at(y), r, look.colour, tip_of(tip));
    return;
  }
  std::string places;
  for (const auto& [dx, dy] : corners)
    places += fmt::format("{}{},{}", places.empty() ? "" : " ", at(x + dx), at(y + dy));
  text_ += fmt::format("<polygon points=\"{}\" fill=\"{}\" stroke=\"#333\" stroke-width=\"0.6\">{}</polygon>\n", places,
                       look.colour, tip_of(tip));
}

void Svg::text(double x, double y, std::string_view words, Anchor anchor, double size, std::string_view colour) {
  text_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\">{}</text>\n", at(x),
                       at(y), size, word_of(anchor), colour, escaped(words));
}

void Svg::text_upward(double x, double y, std::string_view words) {
  text_ += fmt::format(
      "<text transform=\"translate({},{}) rotate(-90)\" font-size=\"12\" text-anchor=\"middle\" "
      "fill=\"#111\">{}</text>\n",
      at(x), at(y), escaped(words));
}

void Svg::whisker(double x, double y1, double y2) {
  constexpr double half = 4;
  line(x, y1, x, y2, "#111", 1.4);
  line(x - half, y1, x + half, y1, "#111", 1.4);
  line(x - half, y2, x + half, y2, "#111", 1.4);
}

std::string Svg::finish() {
  return text_ + "</svg>\n";
}

void draw_y_axis(Svg& svg, const Plot& plot, const std::vector<double>& ticks, std::string_view name) {
  for (const double tick : ticks) {
    svg.line(plot.left, plot.y(tick), plot.left + plot.width, plot.y(tick), "#ddd");
    svg.text(plot.left - 6, plot.y(tick) + 4, fmt::format("{:g}", tick), Anchor::end);
  }
  svg.line(plot.left, plot.top, plot.left, plot.top + plot.height, "#333");
  svg.text_upward(plot.left - 42, plot.top + plot.height / 2, name);
}

void draw_x_axis(Svg& svg, const Plot& plot, const std::vector<double>& ticks, std::string_view name) {
  const double bottom = plot.top + plot.height;
  for (const double tick : ticks) {
    svg.line(plot.x(tick), bottom, plot.x(tick), bottom + 4, "#333");
    svg.text(plot.x(tick), bottom + 17, fmt::format("{:g}", tick), Anchor::middle);
  }
  svg.line(plot.left, bottom, plot.left + plot.width, bottom, "#333");
  svg.text(plot.left + plot.width / 2, bottom + 36, name, Anchor::middle);
}

}  // namespace palpa::study
