// Lines, discs and text in the plane of a picture.
#pragma once

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "base/math.hpp"
#include "drawing/colour.hpp"
#include "drawing/font.hpp"
#include "shaders/viewer/view_scene.h"

namespace palpa::drawing {

inline constexpr double text_size = 9.0;  ///< height of capitals, points

enum class Align { left, centre, right };

/// Strokes in pixels; sizes are given in points.
class Ink {
 public:
  Ink(double ratio, const Colour& paper, std::vector<shader::ViewStroke>& strokes)
      : ratio_(ratio), paper_(paper), strokes_(strokes) {}

  double px(double points) const { return points * ratio_; }
  void line(const Vec2& a, const Vec2& b, double width, const Colour& c) {
    const auto f = [](double v) { return static_cast<float>(v); };
    strokes_.push_back({{f(a.x), f(a.y), 0, f(px(width) / 2)}, {f(b.x), f(b.y), 0, 0}, {c.r, c.g, c.b, c.a}});
  }
  void disc(const Vec2& centre, double radius, const Colour& c) { line(centre, centre, 2 * radius, c); }
  void ring(const Vec2& centre, double radius, double width, const Colour& c) {
    constexpr int pieces = 40;
    Vec2 last = centre + Vec2(px(radius), 0);
    for (int i = 1; i <= pieces; ++i) {
      const double a = 2 * std::numbers::pi * i / pieces;
      const Vec2 next = centre + px(radius) * Vec2(std::cos(a), std::sin(a));
      line(last, next, width, c);
      last = next;
    }
  }
  void swatch(const Vec2& centre, const Colour& fill, const Colour& border) {
    const Vec2 half(px(4.5), 0);
    line(centre - half, centre + half, 10, border);
    line(centre - half, centre + half, 8, paper_);
    line(centre - half, centre + half, 8, fill);
  }
  /// `at` is the start, centre or end of the baseline.
  void text(std::string_view words, Vec2 at, double height, const Colour& c, Align align = Align::left,
            double weight = 1) {
    if (align != Align::left) at.x -= text_width(words, px(height)) * (align == Align::centre ? 0.5 : 1.0);
    pen_.clear();
    write_text(words, at, px(height), pen_);
    for (const PenStroke& s : pen_)
      line(s.from, s.to, weight * (0.55 + 0.088 * height), c);
  }
  /// Text that reads upwards. `at` is the middle of the baseline, which is on the right.
  void text_upwards(std::string_view words, const Vec2& at, double height, const Colour& c) {
    pen_.clear();
    write_text(words, {-text_width(words, px(height)) / 2, 0}, px(height), pen_);
    const auto turned = [&](const Vec2& p) { return at + Vec2(p.y, -p.x); };
    for (const PenStroke& s : pen_)
      line(turned(s.from), turned(s.to), 0.55 + 0.088 * height, c);
  }
  /// Text with a border in the paper's colour, legible on any background.
  void label(std::string_view words, Vec2 at, double height, const Colour& c, Align align = Align::left,
             double weight = 1) {
    text(words, at, height, paper_, align, 3.2 * weight);
    text(words, at, height, c, align, weight);
  }

 private:
  double ratio_;
  Colour paper_;
  std::vector<shader::ViewStroke>& strokes_;
  std::vector<PenStroke> pen_;
};

}  // namespace palpa::drawing
