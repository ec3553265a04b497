// The arithmetic of splitting. The rules are in docs/touch.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "touch/fingers/bridge_math.hpp"
#include "touch/fingers/exact.hpp"

namespace palpa::touch {

/// A walk from contact to contact looks at no more pixels than this.
inline constexpr std::uint32_t split_steps = 64U;
/// The least depth of a valley: metres, and an addition per square metre of distance, as a depth camera's noise grows.
#define PALPA_SPLIT_VALLEY PALPA_TUNED(valley, 1e-3F)
#define PALPA_SPLIT_NOISE PALPA_TUNED(noise, 5e-3F)
/// A gap without data of this width also counts as a valley.
#define PALPA_SPLIT_HOLE PALPA_TUNED(hole, 2e-3F)
/// The inside of a finger lies below its skin by this share of its greatest width. Samples whose insides are nearer
/// than the next constant belong to one finger. Two fingers' insides are at least the last constant apart.
#define PALPA_SPLIT_INSIDE PALPA_TUNED(inside, 0.36F)
#define PALPA_SPLIT_SAME PALPA_TUNED(same, 0.3F)
#define PALPA_SPLIT_APART PALPA_TUNED(apart, 0.45F)
#define PALPA_SPLIT_STILL_APART 0.3F
/// Clusters of a known finger are examined from this share of the greatest width of a finger on.
#define PALPA_SPLIT_KNOWN_WIDE 0.8F
/// Skin turned towards other skin by more than this cosine faces that skin.
#define PALPA_SPLIT_FACING PALPA_TUNED(facing, 0.4F)
/// Limits for the pairs of two parts that one camera sees: a group grows while less than 3/8 show two fingers,
inline constexpr std::uint32_t split_most_eighths = 3U;
/// and parts are fingers if a valley is seen in at least half.
inline constexpr std::uint32_t split_votes = 2U;  // rounds

/// A pixel is firm if this many pixels of the square around it, including itself, are about as far away as it is.
inline constexpr std::uint32_t split_reach = 2U;
inline constexpr std::uint32_t split_window = 5U;
inline constexpr std::uint32_t split_company = 5U;

inline float noise_at(float depth) {
  return plus(PALPA_SPLIT_VALLEY, product(product(PALPA_SPLIT_NOISE, depth), depth));
}

inline bool is_near(float at, float other) {
  return std::abs(less(at, other)) <= noise_at(at);
}

/// Whether a surface supports a cluster with this many firm samples.
/// A known finger needs half of that.
inline bool supported(std::uint32_t seen, std::uint32_t firm, bool known) {
  return (known ? 4U : 2U) * firm >= PALPA_TUNED(firm, seen);
}

/// A contact as one camera sees it.
struct SplitView {
  Float3 at;  // camera coordinates
  int u, v;
  bool seen;
};

inline SplitView split_view(BridgeCamera camera, Appearance a, std::uint32_t raw, Float3 place) {
  SplitView view;
  view.at = seen_from(camera, place);
  view.u = int(a.u);
  view.v = int(a.v);
  const float step = less(product(float(raw), camera.depth_unit), a.depth);
  view.seen = a.depth > 0.0F && raw >= camera.first_depth && std::abs(step) <= PALPA_BRIDGE_STEP;
  return view;
}

/// A walk over the picture from one contact to another: the skin's height towards the camera, above the straight line
/// between the two.
inline constexpr std::uint32_t split_begun = 0U;
inline constexpr std::uint32_t split_first = 1U;   // one height is known
inline constexpr std::uint32_t split_top = 2U;     // `level` is the highest
inline constexpr std::uint32_t split_bottom = 3U;  // it has fallen by `least`; `level` is the lowest height since
inline constexpr std::uint32_t split_valley = 4U;  // it has risen again by as much
struct SplitWalk {
  std::uint32_t steps;
  std::uint32_t state;
  float tilt;   // the part of a difference in depth that is across the line
  float least;  // depth of a valley
  float stride;
  float level;
  float before;  // the height before
  float hole;    // width of the hole that the walk is in
};

inline float quotient(float a, float b) {
  float q = a / b;
  return q;
}

/// The square root of a quotient.
inline float root_of(float a, float b) {
  float root = std::sqrt(a / b);
  return root;
}

inline int magnitude(int i) {
  return i < 0 ? -i : i;
}

inline SplitWalk walk_between(SplitView a, SplitView b) {
  SplitWalk w;
  const int across = magnitude(b.u - a.u);
  const int down = magnitude(b.v - a.v);
  const std::uint32_t pixels = std::uint32_t(across > down ? across : down);
  w.steps = pixels < split_steps ? pixels : split_steps;
  const Float3 way = minus(b.at, a.at);
  const float lateral = plus(product(way.x, way.x), product(way.y, way.y));
  const float square = dot3(way, way);
  const float farther = a.at.z > b.at.z ? a.at.z : b.at.z;
  w.state = split_begun;
  w.tilt = square > 0.0F ? root_of(lateral, square) : 0.0F;
  w.least = noise_at(farther);
  w.stride = w.steps > 0U ? quotient(root_of(lateral, 1.0F), float(w.steps)) : 0.0F;
  w.level = 0.0F;
  w.before = 0.0F;
  w.hole = 0.0F;
  return w;
}

/// Pixel `step` of `steps` from a to b, rounded. It uses floats, because vectors have no integer division. Numbers are
/// below 2^24, and a quotient of them is no nearer to the next integer than 1 / 128, so the half that is added
/// outweighs rounding.
inline std::uint32_t pixel_between(int a, int b, std::uint32_t step, std::uint32_t steps) {
  const int n = int(steps);
  const float halves = plus(float(2 * (b - a) * int(step) + n), 0.5F);
  return std::uint32_t(a + int(std::floor(quotient(halves, float(2 * n)))));
}

/// Depth of the straight line from a to b at that step.
inline float line_depth(float a, float b, std::uint32_t step, std::uint32_t steps) {
  const float share = quotient(float(step), float(steps));
  return quotient(product(a, b), plus(b, product(share, less(a, b))));
}

inline SplitWalk walked_hole(SplitWalk w) {
  w.hole = plus(w.hole, w.stride);
  if (w.hole >= PALPA_SPLIT_HOLE && w.state < split_bottom) {
    w.state = split_bottom;
    w.level = -1.0F;
  }
  return w;
}

/// Adds the next place of which the camera has data. Only two consecutive places make a height or a depth, so a single
/// pixel does not.
inline SplitWalk walked(SplitWalk w, float line, float seen) {
  const float height = product(less(line, seen), w.tilt);
  const float high = height < w.before ? height : w.before;
  const float low = height > w.before ? height : w.before;
  w.before = height;
  w.hole = 0.0F;
  if (w.state == split_begun) {
    w.state = split_first;
  } else if (w.state == split_first) {
    w.level = high;
    w.state = split_top;
  } else if (w.state == split_top) {
    if (high > w.level) w.level = high;
    if (less(w.level, low) >= w.least) {
      w.level = low;
      w.state = split_bottom;
    }
  } else if (w.state == split_bottom) {
    if (low < w.level) w.level = low;
    if (less(high, w.level) >= w.least) w.state = split_valley;
  }
  return w;
}

// ---- a pair of samples ----

inline Float3 inside_of(Float3 position, Float3 normal, float finger_width) {
  return minus(position, scaled(normal, product(PALPA_SPLIT_INSIDE, finger_width)));
}

inline bool one_inside(Float3 a, Float3 b, float finger_width) {
  const float most = product(PALPA_SPLIT_SAME, finger_width);
  return square_apart(a, b) <= product(most, most);
}

inline bool face_each_other(Float3 a, Float3 normal_a, Float3 b, Float3 normal_b) {
  return cosine_of_way(a, normal_a, b) > PALPA_SPLIT_FACING || cosine_of_way(b, normal_b, a) > PALPA_SPLIT_FACING;
}

// ---- groups of samples ----

/// How many of the pairs between two groups give evidence, and how many show two fingers.
struct SplitLink {
  std::uint32_t known, two;
};

inline bool can_grow(SplitLink link) {
  return link.known > 0U && 8U * link.two < PALPA_TUNED(grow, split_most_eighths) * link.known;
}

inline bool surer(SplitLink link, SplitLink other) {
  return link.two * other.known < other.two * link.known;
}

/// Whether two parts are two fingers. `square` is the squared distance between their insides; `link` counts valleys
/// alone. Parts that were two fingers in the frame before stay two with half of the evidence.
inline bool are_fingers(SplitLink link, float square, float finger_width, bool apart) {
  const float least = product(apart ? PALPA_SPLIT_STILL_APART : PALPA_SPLIT_APART, finger_width);
  if (square < product(least, least)) return false;
  return apart ? 4U * link.two >= link.known : link.two > 0U && 2U * link.two >= PALPA_TUNED(votes, link.known);
}

}  // namespace palpa::touch
