#include "touch/fingers/members.hpp"

#include <algorithm>

namespace palpa::touch {
namespace {

constexpr float reach_m = 6e-3F;
/// Contacts of the other frame that are looked at, evenly chosen.
constexpr std::size_t most_looked_at = 128;

struct Mean {
  Float3 sum{0, 0, 0};
  std::size_t count = 0;

  void add(const Float3& place) {
    sum = plus(sum, place);
    ++count;
  }
  Float3 value() const { return scaled(sum, 1.0F / static_cast<float>(count)); }
};

/// Relative to `origin`: the means of all contacts, and of those that the other frame has, too.
struct Means {
  Mean all, common;

  /// `way`: to where the places are in the other frame.
  Means(std::span<const Float3> places, const Float3& origin, const Float3& way, std::span<const Float3> others) {
    const std::size_t step = (others.size() + most_looked_at - 1) / most_looked_at;
    for (const Float3& place : places) {
      const Float3 there = plus(place, way);
      all.add(minus(place, origin));
      for (std::size_t i = 0; i < others.size(); i += step) {
        if (square_apart(others[i], there) > reach_m * reach_m) continue;
        common.add(minus(place, origin));
        break;
      }
    }
  }
};

}  // namespace

Float3 moved_by_members(std::span<const Float3> before, std::span<const Float3> now, const Float3& expected) {
  const Float3 nothing{0, 0, 0};
  if (before.empty() || now.empty()) return nothing;
  const Means old(before, before.front(), expected, now);
  const Means found(now, before.front(), scaled(expected, -1), before);
  const bool complete = old.common.count == before.size() && found.common.count == now.size();
  const bool other = 2 * old.common.count < before.size() && 2 * found.common.count < now.size();
  if (complete || other || old.common.count == 0 || found.common.count == 0) return nothing;
  return minus(minus(found.all.value(), old.all.value()), minus(found.common.value(), old.common.value()));
}

}  // namespace palpa::touch
