#include "acoustics/boundary/near_rules.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <span>

#include "acoustics/elements/triangle_rules.hpp"

namespace palpa::acoustics {
namespace {

/// Two parts nearer than this many times the longer one's sides are divided.
constexpr double close_reach = 1.3;
constexpr int most_cuts = 4;
/// A part this many times as long as high is a needle. It is halved across until it is not; its quarters would also be
/// needles, and close to each other again.
constexpr double needle = 3;
/// Maximum number of products of parts of two patches: that of two equal-sized patches lying on each other.
constexpr std::size_t most_products = 1u << 16;
/// Maximum depth of division, including needles. Faces of a checked body (body_mesh.hpp) need at most about forty;
/// parts that rounding has flattened stay needles however often they are divided.
constexpr int most_levels = 64;
constexpr std::array<Vec2, 3> whole{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
/// Gauss points per variable for patches that touch.
constexpr std::size_t touching_points = 3;

/// Converts (u, v) relative to corners that begin with `first` and run forwards (or back) to the patch's own (u, v),
/// using barycentric coordinates.
std::array<double, 2> turned(double u, double v, std::uint32_t first, bool back) {
  std::array<double, 3> own{};
  const std::array<double, 3> from{1 - u - v, u, v};
  for (std::uint32_t i = 0; i < 3; ++i)
    own[(first + (back ? 3 - i : i)) % 3] = from[i];
  return {own[1], own[2]};
}

void add(PairTable& table, std::array<double, 2> a, std::array<double, 2> b, double weight) {
  table.u.push_back(static_cast<float>(a[0]));
  table.v.push_back(static_cast<float>(a[1]));
  table.other_u.push_back(static_cast<float>(b[0]));
  table.other_v.push_back(static_cast<float>(b[1]));
  table.weight.push_back(static_cast<float>(weight));
}

void pad(PairTable& table) {
  while (table.size() % far_lanes != 0)
    add(table, {0.1, 0.1}, {0.7, 0.2}, 0);
}

PairTable touching_table(Touch touch, std::uint32_t first, std::uint32_t other_first) {
  PairTable table;
  for (const PairSample& s : touching_rule(touch, touching_points)) {
    add(table, turned(s.u, s.v, first, false), turned(s.other_u, s.other_v, other_first, touch == Touch::edge),
        s.weight);
  }
  pad(table);
  return table;
}

/// A part of a patch: a triangle in its (u, v).
struct SubPatch {
  std::array<Vec2, 3> corners;
  Vec3 centre;
  double size;          // longest side,
  std::size_t longest;  // which starts at that corner
  bool slender;

  SubPatch(const Patch& patch, const std::array<Vec2, 3>& uv) : corners(uv) {
    const Vec2 middle = (uv[0] + uv[1] + uv[2]) / 3.0;
    centre = patch.at(middle.x, middle.y);
    const Vec3 a = patch.at(uv[0].x, uv[0].y), b = patch.at(uv[1].x, uv[1].y), c = patch.at(uv[2].x, uv[2].y);
    const std::array<double, 3> sides{glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)};
    longest = static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
    size = sides[longest];
    slender = size * size > needle * glm::length(glm::cross(b - a, c - a));
  }

  Vec2 at(const TriangleSample& s) const {
    return corners[0] + s.u * (corners[1] - corners[0]) + s.v * (corners[2] - corners[0]);
  }
};

/// The pieces of a divided part: quarters, or halves of a needle.
struct Parts {
  std::array<SubPatch, 4> of;
  std::size_t count;
  std::span<const SubPatch> all() const { return std::span(of).first(count); }
  double weight() const { return 1.0 / static_cast<double>(count); }
};

Parts parts_of(const SubPatch& part, const Patch& patch) {
  const auto& [a, b, c] = part.corners;
  if (part.slender) {
    const Vec2 from = part.corners[part.longest], to = part.corners[(part.longest + 1) % 3];
    const Vec2 tip = part.corners[(part.longest + 2) % 3], middle = (from + to) / 2.0;
    const SubPatch first(patch, {from, middle, tip}), second(patch, {middle, to, tip});
    return {{first, second, first, second}, 2};
  }
  const Vec2 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
  return {{SubPatch(patch, {a, ab, ca}), SubPatch(patch, {ab, b, bc}), SubPatch(patch, {ca, bc, c}),
           SubPatch(patch, {bc, ca, ab})},
          4};
}

bool are_close(const SubPatch& a, const SubPatch& b) {
  const Vec3 way = a.centre - b.centre;
  const double near = close_reach * std::max(a.size, b.size);
  return glm::dot(way, way) < near * near;
}

void add_product(PairTable& table, const SubPatch& a, const SubPatch& b, double weight) {
  for (const TriangleSample& s : six_point_rule()) {
    for (const TriangleSample& q : six_point_rule()) {
      const Vec2 at = a.at(s), other = b.at(q);
      add(table, {at.x, at.y}, {other.x, other.y}, s.weight * q.weight * weight);
    }
  }
}

/// Divides two patches until their parts are far enough apart.
class Cutter {
 public:
  Cutter(const Patch& test, const Patch& trial, PairTable& table) : test_(test), trial_(trial), table_(table) {}

  /// `weight`: the ratio of the parts' size to the patches'; `cuts`: remaining divisions, those of needles not counted;
  /// `levels`: remaining levels.
  bool cut(const SubPatch& a, const SubPatch& b, double weight, int cuts, int levels = most_levels) {
    const bool close = are_close(a, b);
    if (!close || cuts == 0 || levels == 0 || products_ >= most_products) {
      add_product(table_, a, b, weight);
      ++products_;
      return !close;
    }
    // Divides only the larger one if the other is less than half its size.
    bool resolved = true;
    if (a.size > 2 * b.size) {
      const Parts parts = parts_of(a, test_);
      for (const SubPatch& part : parts.all())
        resolved &= cut(part, b, weight * parts.weight(), a.slender ? cuts : cuts - 1, levels - 1);
    } else if (b.size > 2 * a.size) {
      const Parts parts = parts_of(b, trial_);
      for (const SubPatch& part : parts.all())
        resolved &= cut(a, part, weight * parts.weight(), b.slender ? cuts : cuts - 1, levels - 1);
    } else {
      const Parts parts = parts_of(a, test_), others = parts_of(b, trial_);
      const double smaller = weight * parts.weight() * others.weight();
      for (const SubPatch& part : parts.all()) {
        for (const SubPatch& other : others.all())
          resolved &= cut(part, other, smaller, a.slender && b.slender ? cuts : cuts - 1, levels - 1);
      }
    }
    return resolved;
  }

 private:
  std::size_t products_ = 0;
  const Patch& test_;
  const Patch& trial_;
  PairTable& table_;
};

}  // namespace

NearRules::NearRules() : same_(touching_table(Touch::same, 0, 0)) {
  for (std::uint32_t a = 0; a < 3; ++a) {
    for (std::uint32_t b = 0; b < 3; ++b) {
      // The neighbour traverses a shared side in the other direction: its table starts where this side ends.
      edge_[a][b] = touching_table(Touch::edge, a, (b + 1) % 3);
      corner_[a][b] = touching_table(Touch::corner, a, b);
    }
  }
  const SubPatch any(Patch{}, whole);
  add_product(apart_, any, any, 1);
  pad(apart_);
}

const PairTable* NearRules::touching(const glm::uvec3& a, const glm::uvec3& b) const {
  std::array<std::array<std::uint32_t, 2>, 3> shared{};
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    for (std::uint32_t j = 0; j < 3; ++j) {
      if (a[static_cast<int>(i)] == b[static_cast<int>(j)]) shared[count++] = {i, j};
    }
  }
  if (count == 3) return &same_;
  if (count == 2) {
    // The side begins at the shared corner that the other one follows.
    const std::size_t start = (shared[0][0] + 1) % 3 == shared[1][0] ? 0 : 1;
    return &edge_[shared[start][0]][shared[1 - start][1]];
  }
  return count == 1 ? &corner_[shared[0][0]][shared[0][1]] : nullptr;
}

const PairTable& NearRules::apart(const Patch& test, const Patch& trial, PairTable& cut, bool& resolved) const {
  const SubPatch a(test, whole), b(trial, whole);
  if (!are_close(a, b)) return apart_;
  for (std::vector<float>* numbers : {&cut.u, &cut.v, &cut.other_u, &cut.other_v, &cut.weight})
    numbers->clear();
  if (!Cutter(test, trial, cut).cut(a, b, 1, most_cuts)) resolved = false;
  pad(cut);
  return cut;
}

}  // namespace palpa::acoustics
