// The arithmetic of splitting, the same in shaders and twin: see exact_math.h. The rules are in docs/touch.md.
#ifndef PALPA_SHADERS_SPLIT_MATH_H
#define PALPA_SHADERS_SPLIT_MATH_H
#include "shaders/touch/bridge/bridge_math.h"
#include "shaders/touch/split/split.h"
PALPA_SHADER_BEGIN

// The least depth of a valley: metres, and an addition per square metre of distance, as a depth camera's noise grows.
#define PALPA_SPLIT_VALLEY PALPA_TUNED(valley, 1e-3f)
#define PALPA_SPLIT_NOISE PALPA_TUNED(noise, 5e-3f)
// A gap without data of this width also counts as a valley.
#define PALPA_SPLIT_HOLE PALPA_TUNED(hole, 2e-3f)
// The inside of a finger lies below its skin by this share of its greatest width. Samples whose insides are nearer than
// the next constant belong to one finger. Two fingers' insides are at least the last constant apart.
#define PALPA_SPLIT_INSIDE PALPA_TUNED(inside, 0.36f)
#define PALPA_SPLIT_SAME PALPA_TUNED(same, 0.3f)
#define PALPA_SPLIT_APART PALPA_TUNED(apart, 0.45f)
#define PALPA_SPLIT_STILL_APART 0.3f
// Clusters of a known finger are examined from this share of the greatest width of a finger on.
#define PALPA_SPLIT_KNOWN_WIDE 0.8f
// Skin turned towards other skin by more than this cosine faces that skin.
#define PALPA_SPLIT_FACING PALPA_TUNED(facing, 0.4f)
// Limits for the pairs of two parts that one camera sees: a group grows while less than 3/8 show two fingers,
PALPA_CONST split_most_eighths = 3u;
// and parts are fingers if a valley is seen in at least half.
PALPA_CONST split_votes = 2u;  // rounds

// A pixel is firm if this many pixels of the square around it, including itself, are about as far away as it is.
PALPA_CONST split_reach = 2u;
PALPA_CONST split_window = 5u;
PALPA_CONST split_company = 5u;

PALPA_FN float noise_at(float depth) {
  return plus(PALPA_SPLIT_VALLEY, product(product(PALPA_SPLIT_NOISE, depth), depth));
}

PALPA_FN bool is_near(float at, float other) {
  return abs(less(at, other)) <= noise_at(at);
}

// Whether a surface supports a cluster with this many firm samples.
// A known finger needs half of that.
PALPA_FN bool supported(uint seen, uint firm, bool known) {
  return (known ? 4u : 2u) * firm >= PALPA_TUNED(firm, seen);
}

// A contact as one camera sees it.
struct SplitView {
  Float3 at;  // camera coordinates
  int u, v;
  bool seen;
};

PALPA_FN SplitView split_view(BridgeCamera camera, Appearance a, uint raw, Float3 place) {
  SplitView view;
  view.at = seen_from(camera, place);
  view.u = int(a.u);
  view.v = int(a.v);
  const float step = less(product(float(raw), camera.depth_unit), a.depth);
  view.seen = a.depth > 0.0f && raw >= camera.first_depth && abs(step) <= PALPA_BRIDGE_STEP;
  return view;
}

// A walk over the picture from one contact to another: the skin's height towards the camera, above the straight line
// between the two.
PALPA_CONST split_begun = 0u;
PALPA_CONST split_first = 1u;   // one height is known
PALPA_CONST split_top = 2u;     // `level` is the highest
PALPA_CONST split_bottom = 3u;  // it has fallen by `least`; `level` is the lowest height since
PALPA_CONST split_valley = 4u;  // it has risen again by as much
struct SplitWalk {
  uint steps;
  uint state;
  float tilt;   // the part of a difference in depth that is across the line
  float least;  // depth of a valley
  float stride;
  float level;
  float before;  // the height before
  float hole;    // width of the hole that the walk is in
};

PALPA_FN float quotient(float a, float b) {
  PALPA_EXACT float q = a / b;
  return q;
}

// The square root of a quotient.
PALPA_FN float root_of(float a, float b) {
  PALPA_EXACT float root = sqrt(a / b);
  return root;
}

PALPA_FN int magnitude(int i) {
  return i < 0 ? -i : i;
}

PALPA_FN SplitWalk walk_between(SplitView a, SplitView b) {
  SplitWalk w;
  const int across = magnitude(b.u - a.u);
  const int down = magnitude(b.v - a.v);
  const uint pixels = uint(across > down ? across : down);
  w.steps = pixels < split_steps ? pixels : split_steps;
  const Float3 way = minus(b.at, a.at);
  const float lateral = plus(product(way.x, way.x), product(way.y, way.y));
  const float square = dot3(way, way);
  const float farther = a.at.z > b.at.z ? a.at.z : b.at.z;
  w.state = split_begun;
  w.tilt = square > 0.0f ? root_of(lateral, square) : 0.0f;
  w.least = noise_at(farther);
  w.stride = w.steps > 0u ? quotient(root_of(lateral, 1.0f), float(w.steps)) : 0.0f;
  w.level = 0.0f;
  w.before = 0.0f;
  w.hole = 0.0f;
  return w;
}

// Pixel `step` of `steps` from a to b, rounded. It uses floats, because vectors have no integer division. Numbers are
// below 2^24, and a quotient of them is no nearer to the next integer than 1 / 128, so the half that is added outweighs
// rounding.
PALPA_FN uint pixel_between(int a, int b, uint step, uint steps) {
  const int n = int(steps);
  const float halves = plus(float(2 * (b - a) * int(step) + n), 0.5f);
  return uint(a + int(floor(quotient(halves, float(2 * n)))));
}

// Depth of the straight line from a to b at that step.
PALPA_FN float line_depth(float a, float b, uint step, uint steps) {
  const float share = quotient(float(step), float(steps));
  return quotient(product(a, b), plus(b, product(share, less(a, b))));
}

PALPA_FN SplitWalk walked_hole(SplitWalk w) {
  w.hole = plus(w.hole, w.stride);
  if (w.hole >= PALPA_SPLIT_HOLE && w.state < split_bottom) {
    w.state = split_bottom;
    w.level = -1.0f;
  }
  return w;
}

// Adds the next place of which the camera has data. Only two consecutive places make a height or a depth, so a single
// pixel does not.
PALPA_FN SplitWalk walked(SplitWalk w, float line, float seen) {
  const float height = product(less(line, seen), w.tilt);
  const float high = height < w.before ? height : w.before;
  const float low = height > w.before ? height : w.before;
  w.before = height;
  w.hole = 0.0f;
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

PALPA_FN Float3 inside_of(Float3 position, Float3 normal, float finger_width) {
  return minus(position, scaled(normal, product(PALPA_SPLIT_INSIDE, finger_width)));
}

PALPA_FN bool one_inside(Float3 a, Float3 b, float finger_width) {
  const float most = product(PALPA_SPLIT_SAME, finger_width);
  return square_apart(a, b) <= product(most, most);
}

PALPA_FN bool face_each_other(Float3 a, Float3 normal_a, Float3 b, Float3 normal_b) {
  return leaving(a, normal_a, b) > PALPA_SPLIT_FACING || leaving(b, normal_b, a) > PALPA_SPLIT_FACING;
}

// ---- groups of samples ----

// How many of the pairs between two groups give evidence, and how many show two fingers.
struct SplitLink {
  uint known, two;
};

PALPA_FN bool can_grow(SplitLink link) {
  return link.known > 0u && 8u * link.two < PALPA_TUNED(grow, split_most_eighths) * link.known;
}

PALPA_FN bool surer(SplitLink link, SplitLink other) {
  return link.two * other.known < other.two * link.known;
}

// Whether two parts are two fingers. `square` is the squared distance between their insides; `link` counts valleys
// alone. Parts that were two fingers in the frame before stay two with half of the evidence.
PALPA_FN bool are_fingers(SplitLink link, float square, float finger_width, bool apart) {
  const float least = product(apart ? PALPA_SPLIT_STILL_APART : PALPA_SPLIT_APART, finger_width);
  if (square < product(least, least)) return false;
  return apart ? 4u * link.two >= link.known : link.two > 0u && 2u * link.two >= PALPA_TUNED(votes, link.known);
}

PALPA_SHADER_END
#endif
