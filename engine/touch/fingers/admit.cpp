#include "touch/fingers/admit.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "touch/fingers/known.hpp"

namespace palpa::touch {
namespace {

using PerFinger = std::array<bool, max_fingers>;

/// Which known finger each finger of the frame is, and for each known finger the largest finger that claims it.
struct Claims {
  std::array<WhichKnown, max_fingers> of{};
  std::array<std::optional<std::uint32_t>, max_fingers> heir{};

  Claims(const Known& known, const Touch& touch, const FingerSkins& skins) {
    const auto contacts = [&](std::uint32_t f) { return touch.fingers[f].contact_count; };
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const Finger& finger = touch.fingers[f];
      const WhichKnown k = of[f] =
          skins[f].samples.empty() ? known_at(known, finger.solid, first_place(touch, finger)) : skins[f].known;
      if (k && (!heir[*k] || contacts(f) > contacts(*heir[*k]))) heir[*k] = f;
    }
  }
  bool is_heir(std::uint32_t f) const { return of[f] && heir[*of[f]] == f; }
  /// Whether `f` is a small cluster beside a known finger.
  bool is_island(const Known& known, const Finger& finger, const FingerSkin& skin, std::uint32_t f) const {
    const WhichKnown k = of[f] ? of[f] : known_nearby(known, finger.solid, skin.samples);
    if (!k || !heir[*k] || heir[*k] == f) return false;
    const bool same = of[f] == k && !skin.samples.empty();
    return small_beside(finger.contact_count, known.table->fingers[*k].continuation.fall.contacts, same);
  }
};

/// The middle of a cluster's insides. Without samples, the place of its first contact.
glm::vec3 middle_inside(const Touch& touch, const Finger& finger, const FingerSkin& skin, float width) {
  if (skin.samples.empty()) return first_place(touch, finger);
  const glm::vec3 first = inside_of(skin.samples.front(), width);
  glm::vec3 sum{0};
  for (const SkinSample& sample : skin.samples)
    sum += inside_of(sample, width) - first;
  return first + sum * (1.0F / static_cast<float>(skin.samples.size()));
}

/// One frame's decisions.
struct Admission {
  const FingerOptions& parameters;
  const Known& known;
  const Touch& touch;
  const FingerSkins& skins;
  const Claims claims{known, touch, skins};
  InplaceVector<Spot, max_fingers> islands{};  ///< of this frame
  std::array<bool, max_fingers> seen{};        ///< islands of the frame before
  InplaceVector<Spot, max_fingers> ended{};    ///< before this frame, and still to be remembered

  void remember_ended() {
    if (known.table == nullptr) return;
    for (Spot spot : known.table->ended) {
      spot.us = us_after(spot.us, known.elapsed_us);
      if (spot.us < ended_us_most) ended.push_back(spot);
    }
  }

  /// Whether it lies where a finger has ended, and does not press. The end is then remembered as long again.
  bool hovers(const Finger& finger, const FingerSkin& skin) {
    const glm::vec3 inside = middle_inside(touch, finger, skin, known.finger_width);
    const float reach = 0.5F * known.finger_width;
    const auto before = std::ranges::find_if(ended, [&](const Spot& other) {
      return other.solid == finger.solid && square_apart(other.place, inside) <= reach * reach;
    });
    if (before == ended.end()) return false;
    const auto presses = std::ranges::count_if(
        finger.contacts, [&](std::uint32_t i) { return touch.contacts[i].depth_m >= pressing_m; });
    if (static_cast<std::uint32_t>(presses) >= least_contacts(parameters.min_points, false)) return false;
    before->us = 0;
    return true;
  }

  /// Whether the cluster has been there for long enough.
  bool has_waited(const Finger& finger) {
    Spot island{first_place(touch, finger), finger.solid};
    for (std::size_t k = 0; k < known.table->islands.size(); ++k) {
      const Spot& before = known.table->islands[k];
      if (!same_island(island, before)) continue;
      seen[k] = true;
      island.us = std::max(island.us, us_after(before.us, known.elapsed_us));
    }
    if (island.us >= island_wait_us) return true;
    islands.push_back(island);
    return false;
  }

  bool is_finger(std::uint32_t f) {
    const Finger& finger = touch.fingers[f];
    const WhichKnown claimed = claims.of[f];
    const bool goes_on =
        known.rules.few && claims.is_heir(f) &&
        !next_fall(known.table->fingers[*claimed].continuation.fall, contacts_in_shell(touch, finger)).falls;
    if (finger.contact_count < least_contacts(parameters.min_points, goes_on)) return false;
    const bool faint = !claimed && small_alone(finger.contact_count, parameters.min_points);
    const bool again = known.rules.again && !claimed && hovers(finger, skins[f]);
    if (again && faint) return false;
    const bool may_wait = known.table != nullptr && known.rules.islands;
    const bool waits = again || (may_wait && (faint || claims.is_island(known, finger, skins[f], f)));
    return !waits || has_waited(finger);
  }

  void remember_islands() {
    if (known.table == nullptr) return;
    for (std::size_t k = 0; k < known.table->islands.size(); ++k) {
      Spot island = known.table->islands[k];
      if (seen[k] || island.us <= known.elapsed_us || islands.size() == max_fingers) continue;
      island.us -= known.elapsed_us;
      islands.push_back(island);
    }
  }
};

/// Whether a contact of one finger is within the finger gap of one of the other's.
bool are_next_to_each_other(const Touch& touch, const Finger& a, const Finger& b, double gap_m) {
  const auto gap = static_cast<float>(gap_m);
  return std::ranges::any_of(a.contacts, [&](std::uint32_t i) {
    const glm::vec3& place = touch.contacts[i].position;
    return std::ranges::any_of(b.contacts, [&](std::uint32_t other) {
      return square_apart(place, touch.contacts[other].position) <= gap * gap;
    });
  });
}

/// The heir that gets the skin of `f`, which is no finger: that of the known finger to which it belongs; if it belongs
/// to none, that of the nearest known finger, if both are within the finger gap.
std::optional<std::uint32_t> heir_of_skin(const Admission& admission, std::uint32_t f) {
  const Claims& claims = admission.claims;
  const Finger& finger = admission.touch.fingers[f];
  if (admission.skins[f].samples.empty()) return {};
  if (claims.of[f]) return claims.heir[*claims.of[f]];
  const WhichKnown beside = known_nearby(admission.known, finger.solid, admission.skins[f].samples);
  if (!beside || !claims.heir[*beside]) return {};
  const Finger& heir = admission.touch.fingers[*claims.heir[*beside]];
  if (!are_next_to_each_other(admission.touch, finger, heir, admission.parameters.finger_gap_m)) return {};
  return claims.heir[*beside];
}

/// Skin of known fingers, or beside them, that does not become a finger of its own is the heir's. Returns which fingers
/// grow by it.
PerFinger give_to_heirs(const Admission& admission, const PerFinger& stays, Touch& out) {
  std::array<std::optional<std::uint32_t>, max_fingers> heirs{};
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    if (!stays[f]) heirs[f] = heir_of_skin(admission, f);
  }
  PerFinger grows{};
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    if (!heirs[f] || !stays[*heirs[f]]) continue;
    std::vector<std::uint32_t>& all = out.fingers[*heirs[f]].contacts;
    all.insert(all.end(), out.fingers[f].contacts.begin(), out.fingers[f].contacts.end());
    grows[*heirs[f]] = true;
  }
  return grows;
}

/// Remembers the known fingers that none of the frame's fingers are.
void remember_missing(const Claims& claims, const PerFinger& stays, const Touch& out, const KnownFingers& table,
                      InplaceVector<Spot, max_fingers>& ended) {
  PerFinger goes_on{};
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    if (stays[f] && claims.of[f]) goes_on[*claims.of[f]] = true;
  }
  for (std::uint32_t k = 0; k < table.count; ++k) {
    if (goes_on[k] || ended.size() == max_fingers) continue;
    const KnownFinger& finger = table.fingers[k];
    ended.push_back({(finger.low + finger.high) * 0.5F, finger.solid, 0});
  }
}

}  // namespace

Continuations admit_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known,
                            KnownFingers& table, Touch& out, FingerSkins& skins) {
  Admission admission{parameters, known, out, skins};
  const Claims& claims = admission.claims;
  admission.remember_ended();
  PerFinger stays{};
  for (std::uint32_t f = 0; f < out.finger_count; ++f)
    stays[f] = admission.is_finger(f);
  admission.remember_islands();
  if (known.table) remember_missing(claims, stays, out, table, admission.ended);
  const PerFinger grows = known.rules.whole ? give_to_heirs(admission, stays, out) : PerFinger{};

  Continuations continuations{};
  std::uint32_t kept = 0;
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    if (!stays[f]) continue;
    Finger& finger = out.fingers[f];
    if (grows[f]) {
      std::ranges::sort(finger.contacts);
      finger.contact_count = static_cast<std::uint32_t>(finger.contacts.size());
      skins[f] = look_at(sight, known, out, finger);
    }
    if (claims.of[f]) continuations[kept] = next_continuation(table.fingers[*claims.of[f]], known.elapsed_us);
    if (kept != f) {
      std::swap(out.fingers[kept], finger);
      skins[kept] = skins[f];
    }
    ++kept;
  }
  out.cluster_count -= out.finger_count - kept;
  out.finger_count = kept;
  table.ended = admission.ended;
  table.islands = admission.islands;
  for (KnownFinger& finger : table.fingers)
    finger.doubt = {};
  return continuations;
}

}  // namespace palpa::touch
