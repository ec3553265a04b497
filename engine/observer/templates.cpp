#include "observer/templates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/system/parallel.hpp"
#include "observer/afferents/skin_sites.hpp"

namespace palpa::observer {
namespace {

/// The offsets of depth that stand for a normal distribution with a standard deviation of 3 mm: Gauss and Hermite's
/// three nodes.
constexpr double offset_m = 3e-3;
struct Node {
  double offset_m, weight;
};
std::vector<Node> nodes_of(const Variant& variant) {
  if (variant.depth != Depth::offset) return {{0, 1}};
  const double away = std::sqrt(3.0) * offset_m;
  return {{-away, 1.0 / 6}, {0, 2.0 / 3}, {away, 1.0 / 6}};
}

using Map = std::vector<double>;

/// The values that a variant uses of one touch, before they are scaled; empty if nothing sounds.
Map values_of(const TouchResponse& touch, const Variant& variant, std::size_t level, double per_count) {
  const auto of = [](const std::vector<float>& values, double factor) {
    Map map(values.begin(), values.end());
    for (double& value : map)
      value *= factor;
    return map;
  };
  switch (variant.cue) {
    case Cue::spikes:
    case Cue::class_sums:
      return touch.counts.empty() ? Map() : of(touch.counts[level], per_count);
    case Cue::spikes_at_once:
      return of(touch.at_once, per_count);
    case Cue::stress:
      return of(touch.mean_stress, 1);
    case Cue::flutter:
      return of(touch.flutter, 1);
    case Cue::vibration:
      return of(touch.vibration, 1);
  }
  return {};
}

bool is_used(Classes classes, AfferentClass kind) {
  return classes == Classes::all || kind == (classes == Classes::ra ? AfferentClass::ra : AfferentClass::pc);
}

/// The same as features of unit noise, appended to `out`.
class Scaling {
 public:
  Scaling(const Responses& responses, const Variant& variant, double largest)
      : responses_(responses), variant_(variant), floor_(1e-3 * largest) {}

  void append(const Map& map, Map& out) const {
    const bool of_afferents = variant_.cue <= Cue::class_sums;
    if (of_afferents) {
      append_spikes(map, out);
    } else {
      append_map(map, out);
    }
  }

 private:
  void append_spikes(const Map& map, Map& out) const {
    const std::vector<double>& areas = responses_.areas_cm2;
    std::array<double, afferent_classes> sums{};
    for (std::size_t m = 0; m < model_count; ++m) {
      const AfferentClass kind = afferent_models()[m].kind;
      if (!is_used(variant_.classes, kind)) continue;
      for (std::size_t s = 0; s < areas.size(); ++s) {
        const double count = map.empty() ? 0 : map[s * model_count + m], afferents = afferents_at(areas[s], kind);
        if (variant_.cue == Cue::class_sums) {
          sums[static_cast<std::size_t>(kind)] += afferents * count;
        } else {
          // n equal afferents with noise of their own count as one with sqrt(n) times the value.
          out.push_back(std::sqrt(afferents) * (variant_.scale == Scale::root ? std::sqrt(count) : count));
        }
      }
    }
    if (variant_.cue != Cue::class_sums) return;
    for (const double sum : sums)
      out.push_back(std::sqrt(sum));
  }

  void append_map(const Map& map, Map& out) const {
    const std::vector<double>& areas = responses_.areas_cm2;
    double total = 0, square = 0;
    for (std::size_t s = 0; s < map.size(); ++s) {
      total += areas[s] * map[s];
      square += areas[s] * map[s] * map[s];
    }
    if (variant_.scale == Scale::total) {
      out.push_back(total);
      return;
    }
    const double whole = square > 0 ? std::sqrt(square) : 1;
    for (std::size_t s = 0; s < areas.size(); ++s) {
      double value = map.empty() ? 0 : map[s];
      if (variant_.scale == Scale::logarithm) value = floor_ > 0 ? std::log(std::max(value, floor_) / floor_) : 0;
      if (variant_.scale == Scale::pattern) value /= whole;
      out.push_back(std::sqrt(areas[s]) * value);
    }
  }

  const Responses& responses_;
  const Variant& variant_;
  double floor_;
};

/// The map at a depth between those of the list: silence at the surface, and no change below the deepest.
Map at_depth(const std::vector<Map>& maps, const std::vector<double>& depths, double depth) {
  const auto scaled = [](const Map& map, double factor) {
    Map out = map;
    for (double& value : out)
      value *= factor;
    return out;
  };
  if (depth <= 0) return {};
  if (depth >= depths.back()) return maps.back();
  if (depth < depths.front()) return scaled(maps.front(), depth / depths.front());
  std::size_t above = 1;
  while (depths[above] < depth)
    ++above;
  const double share = (depth - depths[above - 1]) / (depths[above] - depths[above - 1]);
  Map low = scaled(maps[above - 1], 1 - share);
  const Map high = scaled(maps[above], share);
  low.resize(std::max(low.size(), high.size()));
  for (std::size_t i = 0; i < high.size(); ++i)
    low[i] += high[i];
  return low;
}

Map averaged(const std::vector<Map>& maps) {
  Map sum;
  for (const Map& map : maps) {
    sum.resize(std::max(sum.size(), map.size()));
    for (std::size_t i = 0; i < map.size(); ++i)
      sum[i] += map[i];
  }
  return sum;
}

double product(const Map& a, const Map& b) {
  // Four sums, so that the processor can work on them at once.
  std::array<double, 4> sums{};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k)
      sums[k] += a[i + k] * b[i + k];
  }
  for (; i < a.size(); ++i)
    sums[0] += a[i] * b[i];
  return sums[0] + sums[1] + sums[2] + sums[3];
}

}  // namespace

Templates templates_of(const Responses& responses, std::size_t method, const Variant& variant, std::size_t level,
                       double seconds_per_depth) {
  const std::vector<Node> nodes = nodes_of(variant);
  Templates out{.shapes = responses.shapes.size(),
                .placements = responses.placements,
                .node_weights = {},
                .products = {},
                .placement = variant.placement};
  for (const Node& node : nodes)
    out.node_weights.push_back(node.weight);
  const double per_count = seconds_per_depth / responses.seconds_counted;
  double largest = 0;
  if (variant.scale == Scale::logarithm) {
    // The largest of all methods, so that the floor is the same for all.
    for (const TouchResponse& touch : responses.touches) {
      for (const double value : values_of(touch, variant, level, per_count))
        largest = std::max(largest, value);
    }
  }
  const Scaling scaling(responses, variant, largest);
  std::vector<Map> features(out.size());
  for (std::size_t shape = 0; shape < out.shapes; ++shape) {
    for (std::size_t place = 0; place < out.placements; ++place) {
      std::vector<Map> maps;
      for (std::size_t d = 0; d < responses.depths_m.size(); ++d)
        maps.push_back(values_of(responses.at(method, shape, d, place), variant, level, per_count));
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        Map& feature = features[(shape * out.placements + place) * nodes.size() + n];
        if (variant.depth == Depth::averaged) {
          scaling.append(averaged(maps), feature);
          continue;
        }
        for (const double depth : responses.depths_m)
          scaling.append(at_depth(maps, responses.depths_m, depth + nodes[n].offset_m), feature);
      }
    }
  }
  out.products.resize(out.size() * out.size());
  parallel_chunks(out.size(), 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      for (std::size_t b = 0; b <= a; ++b)
        out.products[a * out.size() + b] = product(features[a], features[b]);
    }
  });
  for (std::size_t a = 0; a < out.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b)
      out.products[b * out.size() + a] = out.products[a * out.size() + b];
  }
  return out;
}

double spread_of(const Templates& templates) {
  const std::size_t per_shape = templates.placements * templates.nodes();
  double sum = 0, count = 0;
  for (std::size_t a = 0; a < templates.size(); ++a) {
    for (std::size_t b = a % per_shape; b < templates.size(); b += per_shape) {
      if (a == b) continue;
      sum += templates.square(a, b);
      ++count;
    }
  }
  return count > 0 ? std::sqrt(std::max(0.0, sum / count)) : 0;
}

}  // namespace palpa::observer
