#include "acoustics/elements/triangle_rules.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace palpa::acoustics {

std::span<const TriangleSample> three_point_rule() {
  static constexpr std::array<TriangleSample, 3> rule{
      {{1.0 / 6, 1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}}};
  return rule;
}

std::span<const TriangleSample> six_point_rule() {
  constexpr double a = 0.445948490915965, b = 0.091576213509771;
  constexpr double a_weight = 0.223381589678011 / 2, b_weight = 0.109951743655322 / 2;
  static constexpr std::array<TriangleSample, 6> rule{{{a, a, a_weight},
                                                       {1 - 2 * a, a, a_weight},
                                                       {a, 1 - 2 * a, a_weight},
                                                       {b, b, b_weight},
                                                       {1 - 2 * b, b, b_weight},
                                                       {b, 1 - 2 * b, b_weight}}};
  return rule;
}

std::vector<LineSample> gauss_rule(std::size_t points) {
  std::vector<LineSample> rule(points);
  const auto n = static_cast<double>(points);
  for (std::size_t i = 0; i < points; ++i) {
    // Newton's method for the root of Legendre's polynomial, with a close initial value.
    double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double here = 1, before = 0;
      for (double m = 1; m <= n; ++m) {
        const double next = ((2 * m - 1) * x * here - (m - 1) * before) / m;
        before = here;
        here = next;
      }
      slope = n * (x * here - before) / (x * x - 1);
      x -= here / slope;
    }
    rule[i] = {(1 - x) / 2, 1 / ((1 - x * x) * slope * slope)};
  }
  return rule;
}

namespace {

/// The book's triangle is 0 <= second <= first <= 1; its corners in our order are (0, 0), (1, 0), (1, 1).
struct InBook {
  double first, second;
};

void add(std::vector<PairSample>& rule, InBook a, InBook b, double weight) {
  rule.push_back({a.first - a.second, a.second, b.first - b.second, b.second, weight});
}

void add_both(std::vector<PairSample>& rule, InBook a, InBook b, double weight) {
  add(rule, a, b, weight);
  add(rule, b, a, weight);
}

void add_region(std::vector<PairSample>& rule, Touch touch, double s, double e1, double e2, double e3, double weight) {
  const double s3 = weight * s * s * s;
  switch (touch) {
    case Touch::same: {
      const double w = s3 * e1 * e1 * e2;
      add_both(rule, {s, s * (1 - e1 + e1 * e2)}, {s * (1 - e1 * e2 * e3), s * (1 - e1)}, w);
      add_both(rule, {s, s * e1 * (1 - e2 + e2 * e3)}, {s * (1 - e1 * e2), s * e1 * (1 - e2)}, w);
      add_both(rule, {s * (1 - e1 * e2 * e3), s * e1 * (1 - e2 * e3)}, {s, s * e1 * (1 - e2)}, w);
      break;
    }
    case Touch::edge: {
      const double w = s3 * e1 * e1;
      add(rule, {s, s * e1 * e3}, {s * (1 - e1 * e2), s * e1 * (1 - e2)}, w);
      add(rule, {s, s * e1}, {s * (1 - e1 * e2 * e3), s * e1 * e2 * (1 - e3)}, w * e2);
      add(rule, {s * (1 - e1 * e2), s * e1 * (1 - e2)}, {s, s * e1 * e2 * e3}, w * e2);
      add(rule, {s * (1 - e1 * e2 * e3), s * e1 * e2 * (1 - e3)}, {s, s * e1}, w * e2);
      add(rule, {s * (1 - e1 * e2 * e3), s * e1 * (1 - e2 * e3)}, {s, s * e1 * e2}, w * e2);
      break;
    }
    case Touch::corner: {
      add_both(rule, {s, s * e1}, {s * e2, s * e2 * e3}, s3 * e2);
      break;
    }
  }
}

}  // namespace

std::vector<PairSample> touching_rule(Touch touch, std::size_t points) {
  const std::vector<LineSample> line = gauss_rule(points);
  std::vector<PairSample> rule;
  for (const LineSample& a : line) {
    for (const LineSample& b : line) {
      for (const LineSample& c : line) {
        for (const LineSample& d : line)
          add_region(rule, touch, a.at, b.at, c.at, d.at, a.weight * b.weight * c.weight * d.weight);
      }
    }
  }
  return rule;
}

}  // namespace palpa::acoustics
