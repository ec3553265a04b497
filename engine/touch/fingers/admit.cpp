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
  bool is_heir(std::uint32_t f) const { return of[f] != none && heir[of[f]] == f; }
  /// Whether `f` is a small cluster beside a known finger.
  bool is_island(const Known& known, const Finger& finger, const FingerSkin& skin, std::uint32_t f) const {
    const std::uint32_t k = of[f] != none ? of[f] : known_nearby(known, finger.solid, skin.samples);
    if (k == none || heir[k] == none || heir[k] == f) return false;
    const bool same = of[f] == k && !skin.samples.empty();
    return small_beside(finger.contact_count, known.table->fingers[k].fall.contacts, same);
  }
};

/// The middle of a cluster's insides. Without samples, the place of its first contact.
Float3 middle_inside(const Touch& touch, const Finger& finger, const FingerSkin& skin, float width) {
  if (skin.samples.empty()) return float3(touch.contacts[finger.contacts.front()].position);
  const Float3 first = inside_of(skin.samples.front(), width);
  Float3 sum{0, 0, 0};
  for (const SkinSample& sample : skin.samples)
    sum = plus(sum, minus(inside_of(sample, width), first));
  return plus(first, scaled(sum, 1.0F / static_cast<float>(skin.samples.size())));
}

/// One frame's decisions.
struct Admission {
  const FingerOptions& parameters;
  const Known& known;
  const Touch& touch;
  const FingerSkins& skins;
  const Claims claims{known, touch, skins};
  InplaceVector<Island, max_fingers> islands{};     ///< of this frame
  std::array<bool, max_fingers> seen{};             ///< islands of the frame before
  InplaceVector<EndedFinger, max_fingers> ended{};  ///< before this frame, and still to be remembered

  void remember_ended() {
    if (known.table == nullptr) return;
    for (EndedFinger finger : known.table->ended) {
      finger.since_us = us_after(finger.since_us, known.elapsed_us);
      if (finger.since_us < ended_us_most) ended.push_back(finger);
    }
  }

  /// Whether it lies where a finger has ended, and does not press. The end is then remembered as long again.
  bool hovers(const Finger& finger, const FingerSkin& skin) {
    const Float3 inside = middle_inside(touch, finger, skin, known.finger_width);
    const float reach = 0.5F * known.finger_width;
    const auto before = std::ranges::find_if(ended, [&](const EndedFinger& other) {
      return other.solid == finger.solid && square_apart(other.inside, inside) <= reach * reach;
    });
    if (before == ended.end()) return false;
    const auto presses = std::ranges::count_if(
        finger.contacts, [&](std::uint32_t i) { return touch.contacts[i].depth_m >= pressing_m; });
    if (static_cast<std::uint32_t>(presses) >= least_contacts(parameters.min_points, false)) return false;
    before->since_us = 0;
    return true;
  }

  /// Whether the cluster has been there for long enough.
  bool has_waited(const Finger& finger) {
    Island island{float3(touch.contacts[finger.contacts.front()].position), finger.solid};
    for (std::size_t k = 0; k < known.table->islands.size(); ++k) {
      const Island& before = known.table->islands[k];
      if (!same_island(island, before)) continue;
      seen[k] = true;
      island.evidence_us = std::max(island.evidence_us, us_after(before.evidence_us, known.elapsed_us));
    }
    if (island.evidence_us >= island_wait_us) return true;
    islands.push_back(island);
    return false;
  }

  bool is_finger(std::uint32_t f) {
    const Finger& finger = touch.fingers[f];
    const std::uint32_t claimed = claims.of[f];
    const bool goes_on = known.has(known_few) && claims.is_heir(f) &&
                         !next_fall(known.table->fingers[claimed].fall, contacts_in_shell(touch, finger)).falls;
    if (finger.contact_count < least_contacts(parameters.min_points, goes_on)) return false;
    const bool faint = claimed == none && small_alone(finger.contact_count, parameters.min_points);
    const bool again = known.has(known_again) && claimed == none && hovers(finger, skins[f]);
    if (again && faint) return false;
    const bool waits = again || (known.has(known_islands) && (faint || claims.is_island(known, finger, skins[f], f)));
    return !waits || has_waited(finger);
  }

  void remember_islands() {
    if (known.table == nullptr) return;
    for (std::size_t k = 0; k < known.table->islands.size(); ++k) {
      Island island = known.table->islands[k];
      if (seen[k] || island.evidence_us <= known.elapsed_us || islands.size() == max_fingers) continue;
      island.evidence_us -= known.elapsed_us;
      islands.push_back(island);
    }
  }
};

}  // namespace

ClaimList admit_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known, KnownFingers& table,
                        Touch& out, FingerSkins& skins) {
  Admission admission{parameters, known, out, skins};
  const Claims& claims = admission.claims;
  admission.remember_ended();
  std::array<bool, max_fingers> stays{}, grows{}, goes_on{};
  for (std::uint32_t f = 0; f < out.finger_count; ++f)
    stays[f] = admission.is_finger(f);
  admission.remember_islands();
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    const std::uint32_t claimed = claims.of[f];
    if (claimed == none) continue;
    if (stays[f]) goes_on[claimed] = true;
    const std::uint32_t heir = claims.heir[claimed];
    if (stays[f] || !stays[heir] || skins[f].samples.empty() || !known.has(known_whole)) continue;
    std::vector<std::uint32_t>& all = out.fingers[heir].contacts;
    all.insert(all.end(), out.fingers[f].contacts.begin(), out.fingers[f].contacts.end());
    grows[heir] = true;
  }

  ClaimList stay{};
  std::uint32_t kept = 0;
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    if (!stays[f]) continue;
    Finger& finger = out.fingers[f];
    if (grows[f]) {
      std::ranges::sort(finger.contacts);
      finger.contact_count = static_cast<std::uint32_t>(finger.contacts.size());
      skins[f] = look_at(sight, known, out, finger);
    }
    if (const std::uint32_t claimed = claims.of[f]; claimed != none) {
      stay[kept].parting_us = next_parting_us(table.fingers[claimed], table.doubts[claimed], known.elapsed_us);
      stay[kept].meeting_us = next_meeting_us(table.fingers[claimed], table.doubts[claimed], known.elapsed_us);
      stay[kept].fall = table.fingers[claimed].fall;
    }
    if (kept != f) {
      std::swap(out.fingers[kept], finger);
      skins[kept] = skins[f];
    }
    ++kept;
  }
  out.cluster_count -= out.finger_count - kept;
  out.finger_count = kept;
  for (std::uint32_t k = 0; known.table != nullptr && k < table.count; ++k) {
    if (goes_on[k] || admission.ended.size() == max_fingers) continue;
    const KnownFinger& finger = table.fingers[k];
    admission.ended.push_back({scaled(plus(finger.low, finger.high), 0.5F), finger.solid, 0});
  }
  table.ended = admission.ended;
  table.islands = admission.islands;
  std::ranges::fill(table.doubts, 0U);
  return stay;
}

}  // namespace palpa::touch
