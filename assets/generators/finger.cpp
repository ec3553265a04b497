#include "assets/generators/finger.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "assets/generators/shape.hpp"

namespace palpa::assets {
namespace {

using geometry::Mesh;

constexpr double kLength = 0.050;
constexpr double kTipRadius = 0.008;    ///< of curvature, and at the beginning of the shaft
constexpr double kWidening = 0.03;      ///< radius gained per length
constexpr double kEndRounding = 0.006;  ///< like kTipRadius, at the closed end
constexpr double kFlattening = 0.10;    ///< of the shaft along z
constexpr double kTipSpacing = 0.0005, kShaftSpacing = 0.0014;
constexpr double kFineArc = 0.0025;                ///< the tip's spacing reaches this far along the skin
constexpr double kRowHeight = 0.9;                 ///< of the spacing: between a disc's rows (1) and a plane's (0.87)
constexpr std::uint32_t kRingVertices = 2163 - 2;  ///< all but the two poles

/// Half width along x at a height above the tip. Near y = 0 it is sqrt(2 kTipRadius y), a sphere's; tanh blends it into
/// the shaft without a crease.
double half_width(double y) {
  const double cap = std::tanh(2 * y / kTipRadius), end = std::tanh(2 * (kLength - y) / kEndRounding);
  return (kTipRadius + kWidening * y) * std::sqrt(std::max(0.0, cap * end));
}

double half_depth(double y) {
  const double grown = std::tanh(y / 0.012);
  return half_width(y) * (1.0 - kFlattening * grown * grown);
}

/// The profile y(arc length), sampled evenly in an angle-like parameter that resolves both round ends.
struct Profile {
  std::vector<double> arc, y;
  double length() const { return arc.back(); }
  double height_at(double s) const {
    const auto upper = std::clamp<std::ptrdiff_t>(std::upper_bound(arc.begin(), arc.end(), s) - arc.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(arc.size()) - 1);
    const double t = (s - arc[upper - 1]) / (arc[upper] - arc[upper - 1]);
    // Near the ends, y grows with the square of the arc length. The sine's parameter does, too, so a linear step is
    // precise enough.
    return y[upper - 1] + t * (y[upper] - y[upper - 1]);
  }
};

Profile sample_profile() {
  constexpr int kSamples = 20000;
  Profile profile;
  for (int i = 0; i <= kSamples; ++i) {
    const double y = kLength * 0.5 * (1.0 - std::cos(std::numbers::pi * i / kSamples));
    const double step = i == 0 ? 0.0 : std::hypot(y - profile.y.back(), half_width(y) - half_width(profile.y.back()));
    profile.arc.push_back(i == 0 ? 0.0 : profile.arc.back() + step);
    profile.y.push_back(y);
  }
  return profile;
}

struct Row {
  double y;
  std::uint32_t count;
};

/// Rows of vertices from the tip to the end. Their spacing grows by `slope` per arc length beyond the fine tip.
std::vector<Row> lay_rows(const Profile& profile, double slope) {
  const auto spacing = [&](double arc) {
    return std::clamp(kTipSpacing + slope * (arc - kFineArc), kTipSpacing, kShaftSpacing);
  };
  // Row k lies where the integral of 1 / row height reaches k. All rows are then stretched so that the last one is
  // whole.
  constexpr int kSteps = 20000;
  std::vector<double> rows_before{0.0};
  const double step = profile.length() / kSteps;
  for (int i = 0; i < kSteps; ++i)
    rows_before.push_back(rows_before.back() + step / (kRowHeight * spacing((i + 0.5) * step)));
  const int row_count = static_cast<int>(std::lround(rows_before.back()));
  std::vector<Row> rows;
  for (int k = 1; k < row_count; ++k) {
    const double wanted = rows_before.back() * k / row_count;
    const auto upper = std::upper_bound(rows_before.begin(), rows_before.end(), wanted) - rows_before.begin();
    const double arc = step * (static_cast<double>(upper) - 1 +
                               (wanted - rows_before[upper - 1]) / (rows_before[upper] - rows_before[upper - 1]));
    const double y = profile.height_at(arc);
    const double around = std::numbers::pi * (half_width(y) + half_depth(y));
    rows.push_back({y, static_cast<std::uint32_t>(std::lround(around / spacing(arc)))});
  }
  return rows;
}

std::uint32_t vertices_of(const std::vector<Row>& rows) {
  std::uint32_t sum = 0;
  for (const Row& row : rows)
    sum += row.count;
  return sum;
}

/// Finds the growth of the spacing that needs exactly the paper's number of vertices: about 56 micrometres per
/// millimetre.
std::vector<Row> find_rows(const Profile& profile) {
  for (double slope = 0.056; slope < 0.2; slope += 0.00002) {
    std::vector<Row> rows = lay_rows(profile, slope);
    if (vertices_of(rows) == kRingVertices) return rows;
  }
  throw std::logic_error("no spacing gives the finger's number of vertices");
}

}  // namespace

Mesh make_finger() {
  const std::vector<Row> rows = find_rows(sample_profile());
  Mesh mesh;
  mesh.positions.emplace_back(0.0, 0.0, 0.0);
  Ring below{0, 1};
  double turn = 0.0;
  for (const Row& row : rows) {
    const Ring ring{static_cast<std::uint32_t>(mesh.positions.size()), row.count};
    for (std::uint32_t i = 0; i < row.count; ++i) {
      const double angle = 2 * std::numbers::pi * (i + turn) / row.count;
      mesh.positions.emplace_back(half_width(row.y) * std::cos(angle), row.y, -half_depth(row.y) * std::sin(angle));
    }
    turn = turn == 0.0 ? 0.5 : 0.0;
    sew(mesh, ring, below);
    below = ring;
  }
  const Ring end{static_cast<std::uint32_t>(mesh.positions.size()), 1};
  mesh.positions.emplace_back(0.0, kLength, 0.0);
  sew(mesh, end, below);
  round_to_float(mesh);
  return mesh;
}

}  // namespace palpa::assets
