#include "viewer/picture/chart.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "acoustics/felt/skin.hpp"
#include "viewer/picture/backing.hpp"

namespace palpa::viewer {
namespace {

constexpr double highest_hz = 600;
constexpr double panel_left = 104, panel_below = 26, panel_width = 400, panel_height = 190;  // points
constexpr std::size_t most_fingers = 4;

bool has_room(double width, double height, double ratio) {
  return panel_left + panel_width + 20 <= width / ratio && panel_height + panel_below + 140 <= height / ratio;
}

/// Converts frequency and value to pixels.
struct Plot {
  double left, right, top, bottom;
  double most;  ///< the value at the top
  Vec2 at(double hz, double value) const {
    return {left + (right - left) * hz / highest_hz, bottom - (bottom - top) * value / most};
  }
};

void draw_grid(Ink& ink, const Plot& plot, const Theme& theme) {
  for (int i = 0; i <= 4; ++i) {
    const double value = plot.most * i / 4;
    ink.line(plot.at(0, value), plot.at(highest_hz, value), i == 0 ? 1.2 : 0.8,
             i == 0 ? theme.ink : with_alpha(theme.faint_ink, 0.35F));
    const std::string share = fmt::format("{:g}{}", 100 * value, i == 4 ? " %" : "");
    ink.text(share, plot.at(0, value) + Vec2(-ink.px(7), ink.px(3)), 7, theme.ink, Align::right);
  }
  for (int hz = 0; hz <= static_cast<int>(highest_hz); hz += 100) {
    const Vec2 foot = plot.at(hz, 0);
    ink.line(foot, foot + Vec2(0, ink.px(4)), 1.2, theme.ink);
    ink.text(fmt::format("{}", hz), foot + Vec2(0, ink.px(14)), 7, theme.ink, Align::centre);
  }
  ink.text("Hz", plot.at(highest_hz, 0) + Vec2(ink.px(14), ink.px(14)), 7, theme.ink);
}

/// The skin's sensitivity, with its best value at the chart's top.
void draw_sensitivity(Ink& ink, const Plot& plot, const Theme& theme) {
  for (int hz = 6; hz + 6 <= static_cast<int>(highest_hz); hz += 12) {
    ink.line(plot.at(hz, plot.most * acoustics::vibration_sensitivity(hz)),
             plot.at(hz + 6, plot.most * acoustics::vibration_sensitivity(hz + 6)), 1.1, theme.faint_ink);
  }
}

void draw_bar(Ink& ink, const Vec2& foot, const Vec2& head, double width, const Colour& colour) {
  const Vec2 end(0, ink.px(width / 2));
  if (foot.y - head.y < 2 * end.y) return;  // shorter than its round ends
  ink.line(foot - end, head + end, width, colour);
}

void draw_bars(Ink& ink, const Plot& plot, const std::vector<std::vector<SpectrumMark>>& spectra) {
  const std::size_t fingers = std::min(spectra.size(), most_fingers);
  const double width = fingers > 1 ? 3.2 : 6;
  for (std::size_t f = 0; f < fingers; ++f) {
    const Colour colour = finger_colour(static_cast<std::uint32_t>(f));
    const double beside = (static_cast<double>(f) - (static_cast<double>(fingers) - 1) / 2) * (width + 0.8);
    const Vec2 shift(ink.px(beside), 0);
    for (const SpectrumMark& line : spectra[f]) {
      if (line.frequency_hz > highest_hz) break;
      const Vec2 foot = plot.at(line.frequency_hz, 0) + shift;
      draw_bar(ink, foot, plot.at(line.frequency_hz, line.around) + shift, width, with_alpha(colour, 0.32F));
      draw_bar(ink, foot, plot.at(line.frequency_hz, line.felt) + shift, width, colour);
    }
  }
}

void draw_key(Ink& ink, const Vec2& at, const Theme& theme) {
  const Colour colour = finger_colour(0);
  ink.line(at, at, 7, with_alpha(colour, 0.32F));
  ink.text("around", at + Vec2(ink.px(9), ink.px(3)), 7, theme.ink);
  const Vec2 felt = at + Vec2(ink.px(72), 0);
  ink.line(felt, felt, 7, colour);
  ink.text("felt", felt + Vec2(ink.px(9), ink.px(3)), 7, theme.ink);
  const Vec2 curve = at + Vec2(ink.px(122), 0);
  ink.line(curve - Vec2(ink.px(6), 0), curve - Vec2(ink.px(2), 0), 1.1, theme.faint_ink);
  ink.line(curve + Vec2(ink.px(2), 0), curve + Vec2(ink.px(6), 0), 1.1, theme.faint_ink);
  ink.text("sensitivity of skin", curve + Vec2(ink.px(12), ink.px(3)), 7, theme.ink);
}

}  // namespace

double chart_top(double most) {
  if (!(most > 1e-9) || most > 1e9) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(most) + 1e-9)), mantissa = most / power;
  return power * (mantissa <= 1 + 1e-9 ? 1 : mantissa <= 2 ? 2 : mantissa <= 5 ? 5 : 10);
}

double chart_share(const Picture& picture, double width, double height, double ratio) {
  if (picture.spectra.empty() || !has_room(width, height, ratio)) return 0;
  return ratio * (panel_left + panel_width) / width;
}

double chart_in_the_way(const Picture& picture, double width, double height, double ratio, double beside) {
  const double share = chart_share(picture, width, height, ratio);
  return share > 0 && share * width + beside > width ? ratio * (panel_below + panel_height) : 0;
}

void draw_chart(Ink& ink, const Picture& picture, double width, double height, const Theme& theme) {
  if (picture.spectra.empty()) return;
  if (!has_room(width, height, ink.px(1))) return;
  const Vec2 size(ink.px(panel_width), ink.px(panel_height)),
      low(ink.px(panel_left), height - ink.px(panel_below) - size.y);
  double most = 0;
  for (const auto& spectrum : picture.spectra) {
    for (const SpectrumMark& line : spectrum) {
      if (line.frequency_hz <= highest_hz) most = std::max(most, line.around);
    }
  }
  draw_backing(ink, low, low + size, theme);
  const Plot plot{low.x + ink.px(44), low.x + size.x - ink.px(30), low.y + ink.px(44), low.y + size.y - ink.px(26),
                  chart_top(most)};
  ink.text("vibration of the skin by frequency, in percent of its mean pressure", low + Vec2(ink.px(8), ink.px(12)), 8,
           theme.ink);
  draw_key(ink, low + Vec2(ink.px(46), ink.px(26)), theme);
  draw_grid(ink, plot, theme);
  draw_bars(ink, plot, picture.spectra);
  draw_sensitivity(ink, plot, theme);
}

}  // namespace palpa::viewer
