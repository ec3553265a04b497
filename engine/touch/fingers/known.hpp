// What a frame's fingers leave for the next frame, and the arithmetic of the decisions that depend on it. The rules are
// in docs/touch-frames.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/inplace_vector.hpp"
#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/exact.hpp"
#include "touch/fingers/sight.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

inline constexpr std::uint32_t known_none = 0xffffffff;
static_assert(shader::reach_most_fingers == max_fingers);

/// How a finger loses its contacts, see next_fall().
struct Fall {
  std::uint32_t contacts = 0;  ///< in the shell
  std::uint32_t from = 0;      ///< before it began to lose them, frame after frame; 0: it does not lose them
  bool falls = false;          ///< it leaves
};

inline constexpr std::uint32_t known_never = 0xffffffff;
/// A finger of the frame before.
struct KnownFinger {
  std::uint32_t solid = 0;
  std::uint32_t samples = 0;
  Float3 low{}, high{};                    ///< the box of its insides
  std::uint32_t parting_us = known_never;  ///< since it last looked like several fingers
  std::uint32_t meeting_us = 0;            ///< for how long it has looked like one with another
  shader::vec4 velocity{};                 ///< of its track
  Fall fall;
};

/// Bits of KnownFingers::doubts: what this frame shows against what is known of a finger.
inline constexpr std::uint32_t doubt_one = 1;    ///< it looks like several fingers
inline constexpr std::uint32_t doubt_apart = 2;  ///< it looks like one with another

/// A small cluster that is not a finger yet.
struct Island {
  Float3 place{};
  std::uint32_t solid = 0;
  std::uint32_t evidence_us = 0;  ///< for how long it has been there, less the time that it was missing
};

/// A finger that has ended.
struct EndedFinger {
  Float3 inside{};  ///< the middle of its insides
  std::uint32_t solid = 0;
  std::uint32_t since_us = 0;
};

struct KnownFingers {
  std::uint32_t count = 0;
  std::array<KnownFinger, max_fingers> fingers{};
  std::array<std::uint32_t, max_fingers> doubts{};  ///< of the known fingers in this frame
  InplaceVector<Island, max_fingers> islands;
  InplaceVector<EndedFinger, max_fingers> ended;
  /// Per finger and sample: inside_of().
  std::array<std::array<Float3, most_samples>, max_fingers> insides{};
  shader::ReachTable reach{};  ///< the fingers that are about to end
};

/// What a finger keeps from the frame before.
struct Claim {
  std::uint32_t parting_us = known_never;  ///< after this frame
  std::uint32_t meeting_us = 0;            ///< after this frame
  Fall fall;
};

/// Skin belongs to a known finger if its inside is within this share of the greatest width of a finger.
inline constexpr float known_reach = 0.4F;
/// An island is not born until it has been there for this time. It is the same island if it begins within this
/// distance.
inline constexpr std::uint32_t island_wait_us = 50000;
inline constexpr float island_reach_m = 8e-3F;

/// Skin at the place of a finger that ended less than this ago is an island, unless min_points contacts are that deep.
inline constexpr std::uint32_t ended_us_most = 500000;
inline constexpr float pressing_m = 0.3e-3F;

/// A known finger with fewer contacts in the shell than this times the least number is about to end. One without any
/// has ended. Skin around its samples up to this distance may be its contacts even beyond the shell's edges.
inline constexpr std::uint32_t known_starving = 8;
inline constexpr float known_around_m = 3e-3F;

inline bool starves(std::uint32_t contacts, std::uint32_t min_points) {
  return contacts > 0U && contacts < known_starving * (min_points > 1U ? min_points : 1U);
}

inline float squared_reach(float farthest) {
  const float reach = farthest + known_around_m;
  return reach * reach;
}

/// A known finger parts if it looks like several fingers in two frames that are no farther apart than this.
inline constexpr std::uint32_t parting_us_most = 100000;
/// Two known fingers become one if they have looked like one in every frame for this time.
inline constexpr std::uint32_t meeting_us_least = 50000;

inline bool may_part(const KnownFinger& finger, std::uint32_t elapsed_us) {
  return us_after(finger.parting_us, elapsed_us) <= parting_us_most;
}
inline bool may_meet(const KnownFinger& finger, std::uint32_t elapsed_us) {
  return us_after(finger.meeting_us, elapsed_us) >= meeting_us_least;
}

inline std::uint32_t next_parting_us(const KnownFinger& finger, std::uint32_t doubts, std::uint32_t elapsed_us) {
  return (doubts & doubt_one) != 0U ? 0U : us_after(finger.parting_us, elapsed_us);
}
inline std::uint32_t next_meeting_us(const KnownFinger& finger, std::uint32_t doubts, std::uint32_t elapsed_us) {
  return (doubts & doubt_apart) != 0U ? us_after(finger.meeting_us, elapsed_us) : 0U;
}

inline bool same_island(const Island& a, const Island& b) {
  return a.solid == b.solid && square_apart(a.place, b.place) <= island_reach_m * island_reach_m;
}

/// The contacts of a finger that are not beyond the shell's edges.
inline std::uint32_t contacts_in_shell(const Touch& touch, const Finger& finger) {
  return static_cast<std::uint32_t>(
      std::ranges::count_if(finger.contacts, [&](std::uint32_t i) { return touch.contacts[i].beyond == 0; }));
}

/// A finger that leaves has fewer contacts in each frame, while those of a finger at rest go up and down. A finger
/// falls if it has lost at least an eighth of its contacts in two frames in a row, and no more than a quarter is left
/// of those with which it began. It falls until it has more than this quarter again.
inline Fall next_fall(Fall before, std::uint32_t contacts) {
  Fall now;
  now.contacts = contacts;
  now.from = before.from;
  now.falls = before.from > 0U && 4U * contacts <= before.from;
  if (before.falls && now.falls) return now;
  const bool loses = 8U * contacts <= 7U * before.contacts;
  if (!loses) now.falls = false;
  now.from = !loses ? 0U : before.from > 0U ? before.from : before.contacts;
  return now;
}

/// The number of contacts that a finger needs.
inline std::uint32_t least_contacts(std::uint32_t min_points, bool known) {
  const std::uint32_t least = min_points > 1U ? min_points : 1U;
  return known ? (least + 1U) / 2U : least;
}

/// Whether `contacts` are few beside a known finger's. A cluster with normals that belongs to that finger (`same`)
/// may be a second finger that parts from it. Any other comes out of nothing, as ghosts do.
inline bool small_beside(std::uint32_t contacts, std::uint32_t known_contacts, bool same) {
  return contacts < known_contacts / (same ? 4U : 2U);
}

/// Whether a cluster that is no known finger has so few contacts that noise can begin and end it.
inline bool small_alone(std::uint32_t contacts, std::uint32_t min_points) {
  return contacts < 2U * least_contacts(min_points, false);
}

}  // namespace palpa::touch
