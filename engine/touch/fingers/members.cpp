#include "touch/fingers/members.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace palpa::touch {
namespace {

constexpr float reach_m = 6e-3F;
constexpr std::size_t most_looked_at = 256;

/// One of `places`, the i-th of those that are looked at. They are spread evenly and without a period, since contacts
/// are in the order of the pictures' rows.
const glm::vec3& looked_at(std::span<const glm::vec3> places, std::size_t i) {
  if (places.size() <= most_looked_at) return places[i];
  const auto turn = static_cast<std::uint32_t>(i) * 0x9e3779b1U;  // of the golden ratio
  return places[(std::uint64_t{turn} * places.size()) >> 32U];
}

struct Mean {
  glm::vec3 sum{0};
  std::size_t count = 0;

  void add(const glm::vec3& place) {
    sum += place;
    ++count;
  }
  glm::vec3 value() const { return sum * (1.0F / static_cast<float>(count)); }
};

/// Relative to `origin`: the means of all contacts, and of those that the other frame has, too.
struct Means {
  Mean all, common;

  /// `way`: to where the places are in the other frame.
  Means(std::span<const glm::vec3> places, const glm::vec3& origin, const glm::vec3& way,
        std::span<const glm::vec3> others) {
    const std::size_t looked = std::min(others.size(), most_looked_at);
    for (const glm::vec3& place : places) {
      const glm::vec3 there = place + way;
      all.add(place - origin);
      for (std::size_t i = 0; i < looked; ++i) {
        if (square_apart(looked_at(others, i), there) > reach_m * reach_m) continue;
        common.add(place - origin);
        break;
      }
    }
  }
  std::size_t missing() const { return all.count - common.count; }
};

/// Both frames, if the skin has moved by `way` from one to the other.
struct Motion {
  Means before, now;

  Motion(std::span<const glm::vec3> old, std::span<const glm::vec3> found, const glm::vec3& way)
      : before(old, old.front(), way, found), now(found, old.front(), -way, old) {}
  std::size_t missing() const { return before.missing() + now.missing(); }
};

}  // namespace

glm::vec3 moved_by_members(std::span<const glm::vec3> before, std::span<const glm::vec3> now,
                           const glm::vec3& expected) {
  const glm::vec3 nothing{0};
  if (before.empty() || now.empty()) return nothing;
  const Motion motion(before, now, expected);
  const Means &old = motion.before, &found = motion.now;
  const bool other = 2 * old.common.count < before.size() && 2 * found.common.count < now.size();
  if (motion.missing() == 0 || other || old.common.count == 0 || found.common.count == 0) return nothing;
  const glm::vec3 shift = found.all.value() - old.all.value();
  // If the contacts are the same ones after the way of their centroid, the skin has moved by it.
  if (2 * Motion(before, now, shift).missing() < motion.missing()) return nothing;
  return shift - (found.common.value() - old.common.value());
}

}  // namespace palpa::touch
