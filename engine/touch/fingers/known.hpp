// What a frame's fingers leave for the next frame, and the arithmetic of the decisions that depend on it. The rules are
// in docs/touch-frames.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "base/inplace_vector.hpp"
#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/exact.hpp"
#include "touch/fingers/sight.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

static_assert(shader::reach_most_fingers == max_fingers);

/// How a finger loses its contacts, see next_fall().
struct Fall {
  std::uint32_t contacts = 0;  ///< in the shell
  std::uint32_t from = 0;      ///< before it began to lose them, frame after frame; 0: it does not lose them
  bool falls = false;          ///< it leaves
};

/// What this frame shows against what is known of a finger.
struct Doubt {
  bool several = false;  ///< it looks like several fingers
  bool apart = false;    ///< it looks like one with another

  void add(const Doubt& other) {
    several = several || other.several;
    apart = apart || other.apart;
  }
};

/// What goes on from frame to frame in a finger. Both times are less the time in which it did not look so.
struct Continuation {
  std::uint32_t parting_us = 0;  ///< for how long it has looked like several fingers
  std::uint32_t meeting_us = 0;  ///< for how long it has looked like one with another
  Fall fall{};
};

/// A finger of the frame before.
struct KnownFinger {
  std::uint32_t solid = 0;
  glm::vec3 velocity{};  ///< of its track
  /// inside_of() each of its samples; without samples, the place of its first contact. And their box.
  InplaceVector<glm::vec3, most_samples> insides;
  glm::vec3 low{}, high{};
  Continuation continuation;
  Doubt doubt;  ///< of this frame
};

/// A known finger by its index; nothing: none of them.
using WhichKnown = std::optional<std::uint32_t>;

/// A place on a solid, and for how long something has held there.
struct Spot {
  glm::vec3 place{};
  std::uint32_t solid = 0;
  std::uint32_t us = 0;
};

struct KnownFingers {
  std::uint32_t count = 0;
  std::array<KnownFinger, max_fingers> fingers{};
  /// Small clusters that are not fingers yet, at their first contacts: for how long each has been there, less the time
  /// that it was missing.
  InplaceVector<Spot, max_fingers> islands;
  InplaceVector<Spot, max_fingers> ended;  ///< fingers, at the middle of their insides: since when
  shader::ReachTable reach{};              ///< the fingers that are about to end
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

/// A known finger parts if it looks like several fingers and has looked so in a frame before, together for this time.
/// Two known fingers become one if they have looked like one for this time.
inline constexpr std::uint32_t parting_us_least = 40000, meeting_us_least = 50000;

inline bool may_part(const Continuation& continuation, std::uint32_t elapsed_us) {
  return continuation.parting_us > 0 && us_after(continuation.parting_us, elapsed_us) >= parting_us_least;
}
inline bool may_meet(const Continuation& continuation, std::uint32_t elapsed_us) {
  return us_after(continuation.meeting_us, elapsed_us) >= meeting_us_least;
}

/// For how long a thing has been so, less the time in which it was not, after a frame that shows whether it is. It is
/// at most `most_us`, so that it can end.
inline std::uint32_t shown_for(std::uint32_t us, bool shows, std::uint32_t elapsed_us, std::uint32_t most_us) {
  if (shows) return std::min(us_after(us, elapsed_us), most_us);
  return us > elapsed_us ? us - elapsed_us : 0;
}

/// After this frame; its contacts do not count yet.
inline Continuation next_continuation(const KnownFinger& finger, std::uint32_t elapsed_us) {
  Continuation next = finger.continuation;
  next.parting_us = shown_for(next.parting_us, finger.doubt.several, elapsed_us, 2 * parting_us_least);
  next.meeting_us = shown_for(next.meeting_us, finger.doubt.apart, elapsed_us, 2 * meeting_us_least);
  return next;
}

inline bool same_island(const Spot& a, const Spot& b) {
  return a.solid == b.solid && square_apart(a.place, b.place) <= island_reach_m * island_reach_m;
}

/// The contacts of a finger that are not beyond the shell's edges.
inline std::uint32_t contacts_in_shell(const Touch& touch, const Finger& finger) {
  return static_cast<std::uint32_t>(
      std::ranges::count_if(finger.contacts, [&](std::uint32_t i) { return touch.contacts[i].beyond == 0; }));
}

/// The place of a finger's first contact.
inline const glm::vec3& first_place(const Touch& touch, const Finger& finger) {
  return touch.contacts[finger.contacts.front()].position;
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
