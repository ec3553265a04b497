#include "touch/fingers/admit.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "touch/fingers/known.hpp"

namespace palpa::touch {
namespace {

constexpr std::uint32_t none = known_none;

/// Which known finger each finger of the frame is, and for each known finger the largest finger that claims it.
struct Claims {
  std::array<std::uint32_t, max_fingers> of{};
  std::array<std::uint32_t, max_fingers> heir{};

  Claims(const Known& known, const Touch& touch, const FingerSkins& skins) {
    heir.fill(none);
    const auto contacts = [&](std::uint32_t f) { return touch.fingers[f].contact_count; };
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const Finger& finger = touch.fingers[f];
      const std::uint32_t k = of[f] =
          skins[f].samples.empty()
              ? known_at(known, finger.solid, float3(touch.contacts[finger.contacts.front()].position))
              : skins[f].known;
      if (k != none && (heir[k] == none || contacts(f) > contacts(heir[k]))) heir[k] = f;
    }
  }
  /// Whether `f` is a small cluster beside a known finger.
  bool is_island(const Known& known, const Finger& finger, const FingerSkin& skin, std::uint32_t f) const {
    const std::uint32_t k = of[f] != none ? of[f] : known_nearby(known, finger.solid, skin.samples);
    if (k == none || heir[k] == none || heir[k] == f) return false;
    const bool same = of[f] == k && !skin.samples.empty();
    return small_beside(finger.contact_count, known.table->fingers[k].fall.contacts, same);
  }
};

}  // namespace

ClaimList admit_fingers(const Parameters& parameters, const Known& known, KnownFingers& table, Touch& out,
                        FingerSkins& skins) {
  const Claims claims(known, out, skins);
  ClaimList stay{};
  std::array<Island, max_fingers> islands{};
  std::uint32_t islands_now = 0, kept = 0;
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    Finger& finger = out.fingers[f];
    const std::uint32_t claimed = claims.of[f];
    const bool goes_on =
        known.has(known_few) && claimed != none && !next_fall(table.fingers[claimed].fall, finger.contact_count).falls;
    bool stays = finger.contact_count >= least_contacts(parameters.min_points, goes_on);
    const bool faint = claimed == none && small_alone(finger.contact_count, parameters.min_points);
    if (stays && known.has(known_islands) && (faint || claims.is_island(known, finger, skins[f], f))) {
      Island island{float3(out.contacts[finger.contacts.front()].position), finger.solid};
      for (std::uint32_t k = 0; k < known.table->islands; ++k) {
        const Island& before = known.table->island[k];
        if (before.solid == island.solid && same_island(island, before))
          island.age_us = std::max(island.age_us, us_after(before.age_us, known.elapsed_us));
      }
      stays = island.age_us >= island_wait_us;
      if (!stays) islands[islands_now++] = island;
    }
    if (!stays) continue;
    if (kept != f) {
      std::swap(out.fingers[kept], finger);
      skins[kept] = skins[f];
    }
    if (claimed != none) {
      stay[kept].parting_us = next_parting_us(table.fingers[claimed], table.doubts[claimed], known.elapsed_us);
      stay[kept].meeting_us = next_meeting_us(table.fingers[claimed], table.doubts[claimed], known.elapsed_us);
      stay[kept].fall = table.fingers[claimed].fall;
    }
    ++kept;
  }
  out.cluster_count -= out.finger_count - kept;
  out.finger_count = kept;
  table.islands = islands_now;
  table.island = islands;
  std::ranges::fill(table.doubts, 0U);
  return stay;
}

}  // namespace palpa::touch
