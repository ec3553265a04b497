#include "touch/fingers/bridge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "touch/fingers/bridge_math.hpp"

namespace palpa::touch {
namespace {

struct Patch {
  SkinSamples samples;  ///< in the order of the hash
  BridgePatch record{};
  std::uint32_t known = known_none;  ///< most of its samples belong to this known finger
};

Patch make_patch(const Sight& sight, const Touch& touch, const Finger& finger) {
  Patch patch{sample_skin(sight, touch, finger)};
  if (patch.samples.empty()) return patch;
  const Float3 first = patch.samples.front().position;
  Float3 low = first, high = first, sum{0, 0, 0};
  for (const SkinSample& sample : patch.samples) {
    const Float3& p = sample.position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    sum = plus(sum, minus(p, first));
  }
  const auto count = static_cast<std::uint32_t>(patch.samples.size());
  const Float3 mean = plus(first, scaled(sum, 1.0F / static_cast<float>(count)));
  patch.record = {{low.x, low.y, low.z, 0}, {high.x, high.y, high.z, 0}, {mean.x, mean.y, mean.z, 0}, count};
  return patch;
}

bool is_seen_empty(const Sight& sight, const Float3& place) {
  for (std::size_t c = 0; c < sight.cameras.size(); ++c) {
    const Appearance seen = appearance(sight.cameras[c], place);
    if (seen.depth > 0 && sees_through(sight.cameras[c], raw_at(sight, c, seen.u, seen.v), seen.depth)) return true;
  }
  return false;
}

/// The line from a sample to the nearest one of the other patch.
struct Way {
  float apart, own, other;  ///< length, and the cosines at its ends
};

Way way_across(const SkinSample& sample, const Patch& other) {
  float nearest = 3.0e38F;
  const SkinSample* there = &other.samples.front();
  for (const SkinSample& candidate : other.samples) {
    const float square = square_apart(sample.position, candidate.position);
    if (square >= nearest) continue;
    nearest = square;
    there = &candidate;
  }
  return {std::sqrt(nearest), cosine_of_way(sample.position, sample.normal, there->position),
          cosine_of_way(there->position, there->normal, sample.position)};
}

/// Whether both patches together are wider than a finger along the line from mean to mean.
bool is_too_wide(const Patch& a, const Patch& b, const Float3& line, float finger_width) {
  float low = 3.0e38F, high = -3.0e38F;
  for (const Patch* patch : {&a, &b}) {
    for (const SkinSample& sample : patch->samples) {
      const float along = dot3(sample.position, line);
      low = std::min(low, along);
      high = std::max(high, along);
    }
  }
  return too_wide(low, high, dot3(line, line), finger_width);
}

/// Whether the lines between contacts that face each other go through a finger.
BridgePair face(const Patch& a, const Patch& b, bool were_one) {
  Evidence e = no_evidence();
  InplaceVector<Way, bridge_samples> from_a, from_b;
  for (const SkinSample& sample : a.samples) {
    from_a.push_back(way_across(sample, b));
    e = with_length(e, from_a.back().apart);
  }
  for (const SkinSample& sample : b.samples) {
    from_b.push_back(way_across(sample, a));
    e = with_length(e, from_b.back().apart);
  }
  for (const Way& way : from_a)
    e = with_way(e, way.apart, way.own, way.other);
  for (const Way& way : from_b)
    e = with_way(e, way.apart, way.other, way.own);
  return facing_verdict(e, were_one);
}

bool is_empty_between(const Sight& sight, const Patch& a, const Patch& b, bool were_one) {
  std::uint32_t looked = 0, empty = 0;
  for (std::uint32_t s = 0; s < a.samples.size(); ++s) {
    const Float3& from = a.samples[s].position;
    const Float3& to = b.samples[chord_end(s, b.record.samples)].position;
    for (std::uint32_t k = bridge_first_step; k <= bridge_last_step; ++k) {
      ++looked;
      empty += is_seen_empty(sight, between(from, to, chord_share(k))) ? 1 : 0;
    }
  }
  return too_empty(empty, looked, were_one);
}

BridgePair compare(const Sight& sight, const Patch& a, const Patch& b, float finger_width, bool were_one) {
  constexpr BridgePair two{bridge_two, 0};
  if (were_one) finger_width = product(PALPA_BRIDGE_STILL_ONE, finger_width);
  if (!near_enough(a.record, b.record, finger_width)) return two;
  const auto mean = [](const Patch& p) { return Float3{p.record.mean.x, p.record.mean.y, p.record.mean.z}; };
  if (is_too_wide(a, b, minus(mean(b), mean(a)), finger_width)) return two;
  const BridgePair pair = face(a, b, were_one);
  return pair.kind != bridge_two && is_empty_between(sight, a, b, were_one) ? two : pair;
}

/// Which patches belong to one finger.
class Joining {
 public:
  explicit Joining(std::uint32_t count) : count_(count), head_(count, 0) {
    for (std::uint32_t p = 0; p < count; ++p)
      head_[p] = p;
  }
  BridgePair& pair(std::uint32_t a, std::uint32_t b) { return pairs_[a][b]; }
  /// The finger's first patch.
  std::uint32_t head(std::uint32_t p) const { return head_[p]; }

  void join() {
    while (join_surest()) {
    }
  }

 private:
  bool join_surest() {
    const BridgePair* surest = nullptr;
    std::uint32_t keeps = 0, goes = 0;
    for (std::uint32_t a = 0; a < count_; ++a) {
      for (std::uint32_t b = a + 1; b < count_; ++b) {
        const BridgePair& candidate = pair(a, b);
        if (candidate.kind != bridge_one || head_[a] == head_[b] || strangers(head_[a], head_[b])) continue;
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
        if (head_[a] == one && head_[b] == other && pair(std::min(a, b), std::max(a, b)).kind == bridge_two)
          return true;
      }
    }
    return false;
  }

  std::uint32_t count_;
  std::array<std::array<BridgePair, max_fingers>, max_fingers> pairs_{};
  InplaceVector<std::uint32_t, max_fingers> head_;
};

}  // namespace

void bridge_fingers(const Sight& sight, const Parameters& parameters, const Known& known, Touch& out) {
  const std::uint32_t count = out.finger_count;
  if (count < 2) return;
  InplaceVector<Patch, max_fingers> patches;
  for (std::uint32_t f = 0; f < count; ++f)
    patches.push_back(make_patch(sight, out, out.fingers[f]));
  if (known.has(known_together)) {
    for (std::uint32_t f = 0; f < count; ++f)
      patches[f].known = known_majority(known_labels(known, out.fingers[f].solid, patches[f].samples));
  }
  Joining joining(count);
  const auto width = static_cast<float>(parameters.finger_width_m);
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) {
      // Patches of a known finger stay one more easily, until it has looked like several fingers before.
      const bool same = patches[a].known != known_none && patches[a].known == patches[b].known;
      const bool were_one = same && !known.may_part(patches[a].known);
      BridgePair& pair = joining.pair(a, b);
      pair = out.fingers[a].solid == out.fingers[b].solid ? compare(sight, patches[a], patches[b], width, were_one)
                                                          : BridgePair{bridge_two, 0};
      if (!same || pair.kind == bridge_one) continue;
      known.doubt(patches[a].known, doubt_one);
      if (were_one && !patches[a].samples.empty() && !patches[b].samples.empty())
        pair = {bridge_one, PALPA_BRIDGE_HELD};
    }
  }
  joining.join();

  std::uint32_t kept = 0;
  std::array<std::uint32_t, max_fingers> place{};
  for (std::uint32_t f = 0; f < count; ++f) {
    Finger& finger = out.fingers[f];
    if (joining.head(f) == f) {
      place[f] = kept++;
      if (place[f] != f) std::swap(out.fingers[place[f]], finger);
      continue;
    }
    std::vector<std::uint32_t>& all = out.fingers[place[joining.head(f)]].contacts;
    all.insert(all.end(), finger.contacts.begin(), finger.contacts.end());
  }
  for (std::uint32_t f = 0; f < kept; ++f) {
    std::sort(out.fingers[f].contacts.begin(), out.fingers[f].contacts.end());
    out.fingers[f].contact_count = static_cast<std::uint32_t>(out.fingers[f].contacts.size());
  }
  out.cluster_count -= count - kept;
  out.finger_count = kept;
}

}  // namespace palpa::touch
