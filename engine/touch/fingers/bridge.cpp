#include "touch/fingers/bridge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/inplace_vector.hpp"
#include "touch/fingers/walk.hpp"
#include "touch/fingers/width_across.hpp"

namespace palpa::touch {
namespace {

/// A cluster of contacts, which may be one patch of several.
struct Patch {
  const SkinSamples* samples;
  WhichKnown known{};               ///< most of its samples belong to this known finger
  glm::vec3 low{}, high{}, mean{};  ///< box and mean of its samples
  glm::vec3 normal{};               ///< normal_of() its samples
};

Patch make_patch(const FingerSkin& skin) {
  Patch patch{&skin.samples, skin.known};
  if (skin.samples.empty()) return patch;
  const glm::vec3 first = skin.samples.front().position;
  glm::vec3 sum{0};
  patch.low = patch.high = first;
  for (const SkinSample& sample : skin.samples) {
    patch.low = glm::min(patch.low, sample.position);
    patch.high = glm::max(patch.high, sample.position);
    sum += sample.position - first;
  }
  patch.mean = first + sum * (1.0F / static_cast<float>(skin.samples.size()));
  patch.normal = normal_of(skin.samples);
  return patch;
}

/// Whether the patches' boxes are near enough that they can be one finger.
bool near_enough(const Patch& a, const Patch& b, float finger_width) {
  if (a.samples->empty() || b.samples->empty()) return false;
  return square_between(a.low, a.high, b.low, b.high) <= finger_width * finger_width;
}

/// Whether a camera has seen something clearly farther away in the direction of a place.
bool is_seen_empty(const Sight& sight, const glm::vec3& place) {
  for (std::size_t c = 0; c < sight.cameras.size(); ++c) {
    const SightCamera& camera = sight.cameras[c];
    const Appearance at = appearance(camera, place);
    if (!(at.depth > 0)) continue;
    const std::uint32_t raw = raw_at(sight, c, at.u, at.v);
    if (raw >= camera.first_depth && static_cast<float>(raw) * camera.depth_unit > at.depth + 4e-3F) return true;
  }
  return false;
}

/// The relation between two patches.
struct Pair {
  enum Kind {
    unknown,  ///< nothing shows that they are one finger
    one,      ///< patches of one finger
    two,      ///< of two fingers, whatever a third patch shows
  } kind = unknown;
  float facing = 0;  ///< the smaller, the more certain: the sum of the cosines of face()
};

// The limits of patches that were one finger in the frame before are wider. That finger may be wider by the first
// factor.
constexpr float still_one = 1.2F;
/// In finger widths: how wide patches with unbroken skin between them may be across the line from mean to mean.
constexpr float wide_across = 1.2F;
/// In place of the sum of cosines, for patches that are one only because they were one: less certain than any other.
constexpr float held = 3;

/// The line from a sample to the nearest one of the other patch.
struct Way {
  float apart, own, other;  ///< length, and the cosines at its ends
};

Way way_across(const SkinSample& sample, const Patch& other) {
  float nearest = 3.0e38F;
  const SkinSample* there = &other.samples->front();
  for (const SkinSample& candidate : *other.samples) {
    const float square = square_apart(sample.position, candidate.position);
    if (square >= nearest) continue;
    nearest = square;
    there = &candidate;
  }
  return {std::sqrt(nearest), cosine_of_way(sample.position, sample.normal, there->position),
          cosine_of_way(there->position, there->normal, sample.position)};
}

/// Whether both patches together are wider than a finger. If they face away from each other, this is from one side of
/// the finger to the other, in the direction in which their normals differ: along a finger that leans, they may be
/// longer. Otherwise it is along the line from mean to mean.
bool is_too_wide(const Patch& a, const Patch& b, float finger_width) {
  const glm::vec3 line = glm::dot(a.normal, b.normal) < 0 ? b.normal - a.normal : b.mean - a.mean;
  float low = 3.0e38F, high = -3.0e38F;
  for (const Patch* patch : {&a, &b}) {
    for (const SkinSample& sample : *patch->samples) {
      const float along = glm::dot(sample.position, line);
      low = std::min(low, along);
      high = std::max(high, along);
    }
  }
  return high - low > finger_width * glm::length(line);
}

/// Whether the line between the means, or those between contacts that face each other, go through a finger: they enter
/// the skin at both ends.
Pair face(const Patch& a, const Patch& b, bool were_one) {
  InplaceVector<Way, std::size_t{2} * most_samples> ways;  // `own` is the end in `a`
  for (const SkinSample& sample : *a.samples)
    ways.push_back(way_across(sample, b));
  for (const SkinSample& sample : *b.samples) {
    const Way way = way_across(sample, a);
    ways.push_back({way.apart, way.other, way.own});
  }
  float nearest = 3.0e38F;
  for (const Way& way : ways)
    nearest = std::min(nearest, way.apart);
  // Contacts that are farther apart than the nearest ones by this much no longer face each other.
  const float farthest = nearest + 2e-3F;
  float at_a = 0, at_b = 0;
  std::uint32_t facing = 0;
  for (const Way& way : ways) {
    if (way.apart > farthest) continue;
    at_a += way.own;
    at_b += way.other;
    ++facing;
  }
  const float mean_a = at_a / static_cast<float>(facing), mean_b = at_b / static_cast<float>(facing);
  const float worse = std::max(mean_a, mean_b);
  if (worse > (were_one ? 0.5F : 0.3F)) return {Pair::two};
  const float through_a = cosine_of_way(a.mean, a.normal, b.mean), through_b = cosine_of_way(b.mean, b.normal, a.mean);
  const bool sure = worse < (were_one ? 0.3F : -0.1F) || std::max(through_a, through_b) < (were_one ? 0.3F : -0.4F);
  return {sure ? Pair::one : Pair::unknown, std::min(mean_a + mean_b, through_a + through_b)};
}

/// Looks at chords through the space between two patches: from each sample of one patch to some sample of the other,
/// in steps of an eighth. Their ends are left out, because pictures of rims are the least reliable there.
bool is_empty_between(const Sight& sight, const Patch& a, const Patch& b, bool were_one) {
  constexpr std::uint32_t first_step = 2, last_step = 6;
  std::uint32_t looked = 0, empty = 0;
  for (std::size_t s = 0; s < a.samples->size(); ++s) {
    const glm::vec3& from = (*a.samples)[s].position;
    const glm::vec3 way = (*b.samples)[(s * 37 + 11) % b.samples->size()].position - from;
    for (std::uint32_t step = first_step; step <= last_step; ++step) {
      ++looked;
      empty += is_seen_empty(sight, from + way * (static_cast<float>(step) * 0.125F)) ? 1 : 0;
    }
  }
  // In 64ths.
  return empty * 64 > looked * (were_one ? 24U : 2U);
}

/// How wide both patches are across the line from mean to mean.
float width_of_both(const Patch& a, const Patch& b) {
  InplaceVector<glm::vec3, std::size_t{2} * most_samples> places;
  for (const Patch* patch : {&a, &b}) {
    for (const SkinSample& sample : *patch->samples)
      places.push_back(sample.position);
  }
  return width_across(places, b.mean - a.mean);
}

/// Whether cameras see unbroken skin from one patch to the other: they see both ends of many lines between samples, and
/// hardly ever a valley in between.
bool is_unbroken(const Sight& sight, const Patch& a, const Patch& b) {
  constexpr std::size_t lines = 5;  // from each sample of `a`
  constexpr std::uint32_t enough = 30;
  std::uint32_t walks = 0, valleys = 0;
  InplaceVector<SeenSample, most_samples> there;
  for (std::size_t c = 0; c < sight.cameras.size(); ++c) {
    there.clear();
    for (const SkinSample& sample : *b.samples)
      there.push_back(seen_sample(sight, c, sample.position));
    for (std::size_t s = 0; s < a.samples->size(); ++s) {
      const SeenSample here = seen_sample(sight, c, (*a.samples)[s].position);
      for (std::size_t line = 0; here.seen && line < std::min(lines, there.size()); ++line) {
        const SeenSample& other = there[(s * 37 + 11 + line * there.size() / lines) % there.size()];
        if (!other.seen) continue;
        ++walks;
        valleys += finds_valley(sight, c, here, other) ? 1 : 0;
      }
    }
  }
  return walks >= enough && 8 * valleys < walks;
}

/// Whether patches between which the skin is unbroken may become one in this frame. Two known fingers become one only
/// if they have looked like one for some time.
bool may_meet(const Known& known, const Patch& a, const Patch& b) {
  if (!a.known || !b.known || a.known == b.known) return true;
  known.doubt(*a.known, {.apart = true});
  known.doubt(*b.known, {.apart = true});
  return known.may_meet(*a.known) && known.may_meet(*b.known);
}

Pair compare(const Sight& sight, const Known& known, const Patch& a, const Patch& b, float finger_width,
             bool were_one) {
  const float widest = were_one ? still_one * finger_width : finger_width;
  if (!near_enough(a, b, widest)) return {Pair::two};
  Pair pair = face(a, b, were_one);
  if (pair.kind == Pair::two) return pair;
  const bool fits = !is_too_wide(a, b, widest) && !is_empty_between(sight, a, b, were_one);
  if (fits && pair.kind == Pair::one) return pair;
  // What is wider than a finger, or empty, in the direction from patch to patch may be along a finger.
  pair.kind = fits ? Pair::unknown : Pair::two;
  if (width_of_both(a, b) <= wide_across * finger_width && is_unbroken(sight, a, b) && may_meet(known, a, b))
    pair.kind = Pair::one;
  return pair;
}

/// Which patches belong to one finger.
class Joining {
 public:
  explicit Joining(std::uint32_t count) : count_(count), head_(count, 0) {
    for (std::uint32_t p = 0; p < count; ++p)
      head_[p] = p;
  }
  Pair& pair(std::uint32_t a, std::uint32_t b) { return pairs_[a][b]; }
  /// The finger's first patch.
  std::uint32_t head(std::uint32_t p) const { return head_[p]; }

  void join() {
    while (join_surest()) {
    }
  }

 private:
  bool join_surest() {
    const Pair* surest = nullptr;
    std::uint32_t keeps = 0, goes = 0;
    for (std::uint32_t a = 0; a < count_; ++a) {
      for (std::uint32_t b = a + 1; b < count_; ++b) {
        const Pair& candidate = pair(a, b);
        if (candidate.kind != Pair::one || head_[a] == head_[b] || strangers(head_[a], head_[b])) continue;
        if (surest && candidate.facing >= surest->facing) continue;
        surest = &candidate;
        keeps = std::min(head_[a], head_[b]);
        goes = std::max(head_[a], head_[b]);
      }
    }
    std::replace(head_.begin(), head_.end(), goes, keeps);
    return surest != nullptr;
  }
  /// Whether any member of `one` and any member of `other` cannot be one finger.
  bool strangers(std::uint32_t one, std::uint32_t other) {
    for (std::uint32_t a = 0; a < count_; ++a) {
      for (std::uint32_t b = 0; b < count_; ++b) {
        if (head_[a] == one && head_[b] == other && pair(std::min(a, b), std::max(a, b)).kind == Pair::two) return true;
      }
    }
    return false;
  }

  std::uint32_t count_;
  std::array<std::array<Pair, max_fingers>, max_fingers> pairs_{};
  InplaceVector<std::uint32_t, max_fingers> head_;
};

using Patches = InplaceVector<Patch, max_fingers>;

/// Notes which known fingers look like several, because their patches are not joined. Those of a finger that may not
/// part are joined.
void hold_patches(const Known& known, const Patches& patches, Joining& joining) {
  bool changed = false;
  for (std::uint32_t a = 0; a < patches.size(); ++a) {
    const WhichKnown finger = patches[a].known;
    for (std::uint32_t b = a + 1; finger && b < patches.size(); ++b) {
      if (patches[b].known != finger || joining.head(a) == joining.head(b)) continue;
      known.doubt(*finger, {.several = true});
      if (known.may_part(*finger) || patches[a].samples->empty() || patches[b].samples->empty()) continue;
      joining.pair(a, b) = {Pair::one, held};
      changed = true;
    }
  }
  if (changed) joining.join();
}

}  // namespace

void bridge_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known, Touch& out,
                    FingerSkins& skins) {
  const std::uint32_t count = out.finger_count;
  if (count < 2) return;
  Patches patches;
  for (std::uint32_t f = 0; f < count; ++f) {
    patches.push_back(make_patch(skins[f]));
    if (!known.rules.together) patches[f].known = {};
  }
  Joining joining(count);
  const auto width = static_cast<float>(parameters.finger_width_m);
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) {
      // Patches of a known finger stay one more easily, until it has looked like several fingers before.
      const bool same = patches[a].known && patches[a].known == patches[b].known;
      const bool were_one = same && !known.may_part(*patches[a].known);
      Pair& pair = joining.pair(a, b);
      pair = out.fingers[a].solid == out.fingers[b].solid
                 ? compare(sight, known, patches[a], patches[b], width, were_one)
                 : Pair{Pair::two};
    }
  }
  joining.join();
  hold_patches(known, patches, joining);

  std::uint32_t kept = 0;
  std::array<std::uint32_t, max_fingers> place{};
  for (std::uint32_t f = 0; f < count; ++f) {
    Finger& finger = out.fingers[f];
    if (joining.head(f) == f) {
      place[f] = kept++;
      if (place[f] == f) continue;
      std::swap(out.fingers[place[f]], finger);
      skins[place[f]] = skins[f];
      continue;
    }
    std::vector<std::uint32_t>& all = out.fingers[place[joining.head(f)]].contacts;
    all.insert(all.end(), finger.contacts.begin(), finger.contacts.end());
  }
  for (std::uint32_t f = 0; f < kept; ++f) {
    Finger& finger = out.fingers[f];
    if (finger.contact_count == finger.contacts.size()) continue;  // nothing was joined to it
    std::ranges::sort(finger.contacts);
    finger.contact_count = static_cast<std::uint32_t>(finger.contacts.size());
    skins[f] = look_at(sight, known, out, finger);
  }
  out.cluster_count -= count - kept;
  out.finger_count = kept;
}

}  // namespace palpa::touch
