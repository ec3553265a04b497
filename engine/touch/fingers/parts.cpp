#include "touch/fingers/parts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "touch/fingers/walk.hpp"
#include "touch/fingers/width_across.hpp"

namespace palpa::touch {
namespace {

template <typename T>
using PerSample = std::array<T, most_samples>;
using Set = std::uint64_t;  ///< of samples
using Sets = PerSample<Set>;

constexpr Set only(std::size_t s) {
  return Set{1} << s;
}
std::uint32_t size_of(Set set) {
  return static_cast<std::uint32_t>(std::popcount(set));
}
std::size_t first_of(Set set) {
  return static_cast<std::size_t>(std::countr_zero(set));
}
/// `set` without its first sample. So `for (Set left = set; left != 0; left = rest_of(left))` visits first_of(left) for
/// each sample, in order.
constexpr Set rest_of(Set set) {
  return set & (set - 1);
}

bool are_two_known(const WhichKnown& one, const WhichKnown& other) {
  return one && other && one != other;
}

float square_of(float a) {
  return a * a;
}

/// Whether skin at one of two samples is turned towards the other.
bool face_each_other(const SkinSample& a, const SkinSample& b) {
  const float least = 0.4F;
  return cosine_of_way(a.position, a.normal, b.position) > least ||
         cosine_of_way(b.position, b.normal, a.position) > least;
}

/// How many of the pairs between two groups give evidence, and how many show two fingers.
struct Evidence {
  std::uint32_t known, two;
};

/// A group grows while less than 3/8 of the pairs show two fingers.
bool can_grow(const Evidence& e) {
  return e.known > 0 && 8 * e.two < 3U * e.known;
}

bool surer(const Evidence& e, const Evidence& other) {
  return e.two * other.known < other.two * e.known;
}

/// Whether two parts are two fingers: their insides are that far apart, and a valley is seen between at least half of
/// the pairs that one camera sees, which `valleys` counts. Parts that were two fingers in the frame before stay two
/// with half of the evidence.
bool are_fingers(const Evidence& valleys, float square, float finger_width, bool apart) {
  if (square < square_of((apart ? 0.3F : 0.45F) * finger_width)) return false;
  return apart ? 4 * valleys.two >= valleys.known : valleys.two > 0 && 2 * valleys.two >= valleys.known;
}

constexpr int vote_rounds = 2;
/// In finger widths: a part that is longer, or wider across its longest line, is no finger.
constexpr float most_length = 4, most_width = 1.5F;
/// In finger widths: samples that are farther apart do not show whether the skin between them is one finger's. The
/// hollow of a palm is a valley between them.
constexpr float near_by = 1.6F;
/// In finger widths: so much farther apart than the nearest samples of two parts, samples show their border.
constexpr float at_border = 0.4F;

/// Assigns the samples of a wide cluster to fingers.
class Grouping {
 public:
  /// `labels`: the samples' known fingers.
  Grouping(const Sight& sight, const SkinSamples& samples, float finger_width, const KnownLabels& labels,
           const Known& known)
      : samples_(samples), labels_(labels), fingers_(known), count_(samples.size()), width_(finger_width) {
    for (std::size_t c = 0; c < sight.cameras.size(); ++c)
      look(sight, c);
    for (std::size_t a = 0; a < count_; ++a) {
      known_[a] = within(a, near_by * width_, looked_[a]);
      two_[a] = known_[a] & valley_[a];
      for (std::size_t b = 0; b < count_; ++b) {
        if (labels_[a] && labels_[b] == labels_[a]) kin_[a] |= only(b);
        if (are_two_known(labels_[a], labels_[b])) strangers_[a] |= only(b);
      }
    }
    compare();
    for (std::size_t s = 0; s < count_; ++s)
      members_[s] = only(s);
    grow();
    for (int round = 0; round < vote_rounds; ++round)
      vote();
    settle();
    hold();
    return_home();
  }

  Parts result() const {
    Parts parts{.insides = insides_, .doubts = doubts_};
    for (std::size_t s = 0; s < count_; ++s)
      parts.part.push_back(static_cast<std::uint8_t>(head(s)));
    for (std::size_t h = 0; h < count_; ++h)
      parts.known[h] = label_of(h);
    return parts;
  }

 private:
  /// The group of a sample: its first sample.
  std::size_t head(std::size_t s) const {
    std::size_t h = 0;
    while ((members_[h] & only(s)) == 0)
      ++h;
    return h;
  }

  /// Those of `others` that are at most so far from `s`.
  Set within(std::size_t s, float reach, Set others) const {
    Set near = 0;
    for (; others != 0; others = rest_of(others)) {
      const std::size_t other = first_of(others);
      if (square_apart(samples_[s].position, samples_[other].position) <= square_of(reach)) near |= only(other);
    }
    return near;
  }

  void look(const Sight& sight, std::size_t c) {
    PerSample<SeenSample> views{};
    for (std::size_t s = 0; s < count_; ++s)
      views[s] = seen_sample(sight, c, samples_[s].position);
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b) {
        if (!views[a].seen || !views[b].seen) continue;
        looked_[a] |= only(b);
        looked_[b] |= only(a);
        // One camera that sees a valley is enough.
        if ((valley_[a] & only(b)) != 0 || !finds_valley(sight, c, views[a], views[b])) continue;
        valley_[a] |= only(b);
        valley_[b] |= only(a);
      }
    }
  }

  /// Adds the evidence of the samples' normals to that of the skin seen between them.
  void compare() {
    for (std::size_t s = 0; s < count_; ++s)
      insides_[s] = inside_of(samples_[s], width_);
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b) {
        if (square_apart(samples_[a].position, samples_[b].position) > square_of(near_by * width_)) continue;
        const bool same = square_apart(insides_[a], insides_[b]) <= square_of(0.3F * width_);
        // Samples of two known fingers are evidence for two.
        if (!same && (strangers_[a] & only(b)) == 0 && !face_each_other(samples_[a], samples_[b])) continue;
        for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
          known_[one] |= only(other);
          two_[one] = same ? two_[one] & ~only(other) : two_[one] | only(other);
          same_[one] |= same ? only(other) : 0;
        }
      }
    }
  }

  Evidence link_between(std::size_t a, std::size_t b, const Sets& known, const Sets& two) const {
    Evidence link{0, 0};
    for (Set left = members_[a]; left != 0; left = rest_of(left)) {
      link.known += size_of(known[first_of(left)] & members_[b]);
      link.two += size_of(two[first_of(left)] & members_[b]);
    }
    return link;
  }

  /// How far apart the nearest samples of two groups are.
  float gap_between(std::size_t a, std::size_t b) const {
    float nearest = 3.0e38F;
    for (Set here = members_[a]; here != 0; here = rest_of(here)) {
      const glm::vec3& place = samples_[first_of(here)].position;
      for (Set there = members_[b]; there != 0; there = rest_of(there))
        nearest = std::min(nearest, square_apart(place, samples_[first_of(there)].position));
    }
    return std::sqrt(nearest);
  }

  /// What cameras see where two groups are next to each other.
  Evidence seen_at_border(std::size_t a, std::size_t b, float gap) const {
    const float reach = std::max(near_by * width_, gap + at_border * width_);
    Evidence link{0, 0};
    for (Set left = members_[a]; left != 0; left = rest_of(left)) {
      const std::size_t s = first_of(left);
      const Set there = within(s, reach, members_[b] & looked_[s]);
      link.known += size_of(there);
      link.two += size_of(there & valley_[s]);
    }
    return link;
  }

  /// Whether two groups, whose means of insides are so far apart, are two fingers. What is near a palm continues it.
  bool are_apart(std::size_t a, std::size_t b, float square, Set palms, bool were_apart) const {
    const float gap = gap_between(a, b);
    if ((palms & (only(a) | only(b))) != 0 && gap <= near_by * width_) return false;
    return are_fingers(seen_at_border(a, b, gap), square, width_, were_apart);
  }

  /// The known finger of most samples of a group; if two have equally many, that of the first sample.
  WhichKnown label_of(std::size_t head) const {
    std::uint32_t most_kin = 0;
    WhichKnown label;
    for (Set left = members_[head]; left != 0; left = rest_of(left)) {
      const std::size_t s = first_of(left);
      const std::uint32_t kin = size_of(members_[head] & kin_[s]);
      if (kin <= most_kin) continue;
      most_kin = kin;
      label = labels_[s];
    }
    return label;
  }
  /// label_of() of each group.
  PerSample<WhichKnown> labels_of_groups() const {
    PerSample<WhichKnown> labels{};
    for (std::size_t h = 0; h < count_; ++h)
      labels[h] = label_of(h);
    return labels;
  }

  void join(std::size_t a, std::size_t b) {
    members_[a] |= members_[b];
    members_[b] = 0;
  }

  /// Grows groups of samples, the most certain pair first.
  void grow() {
    PerSample<PerSample<Evidence>> links{};
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b)
        links[a][b] = links[b][a] = link_between(a, b, known_, two_);
    }
    for (;;) {
      const Evidence* surest = nullptr;
      std::size_t keeps = 0, goes = 0;
      for (std::size_t a = 0; a < count_; ++a) {
        for (std::size_t b = a + 1; b < count_ && members_[a] != 0; ++b) {
          if (members_[b] == 0) continue;
          if (!can_grow(links[a][b]) || (surest && !surer(links[a][b], *surest))) continue;
          surest = &links[a][b];
          keeps = a;
          goes = b;
        }
      }
      if (!surest) return;
      join(keeps, goes);
      for (std::size_t other = 0; other < count_; ++other) {
        Evidence& link = links[keeps][other];
        link = {link.known + links[goes][other].known, link.two + links[goes][other].two};
        links[other][keeps] = link;
      }
    }
  }

  /// Moves each sample to the group that has most of the samples with the same inside.
  void vote() {
    Sets chosen{};
    for (std::size_t s = 0; s < count_; ++s) {
      std::size_t best = head(s);
      std::uint32_t most_same = size_of(same_[s] & members_[best]);
      for (std::size_t h = 0; h < count_; ++h) {
        const std::uint32_t size = size_of(same_[s] & members_[h]);
        if (size <= most_same) continue;
        most_same = size;
        best = h;
      }
      chosen[best] |= only(s);
    }
    name_by_first(chosen);
  }

  /// The number of groups of each known finger, and the first of them.
  struct PartsOfKnown {
    std::array<std::uint32_t, max_fingers> count{};
    std::array<std::size_t, max_fingers> first{};
  };
  PartsOfKnown parts_of_known(const PerSample<WhichKnown>& labels) const {
    PartsOfKnown parts;
    for (std::size_t h = count_; h-- > 0;) {
      if (!labels[h]) continue;
      ++parts.count[*labels[h]];
      parts.first[*labels[h]] = h;
    }
    return parts;
  }

  /// Moves each sample of a known finger to the part of most of that finger's samples, if there is only one. So the
  /// border between two known fingers does not depend on which contacts happen to be samples.
  void return_home() {
    const PartsOfKnown parts = parts_of_known(labels_of_groups());
    Sets chosen{};
    for (std::size_t s = 0; s < count_; ++s) {
      const WhichKnown label = labels_[s];
      chosen[label && parts.count[*label] == 1 ? parts.first[*label] : head(s)] |= only(s);
    }
    name_by_first(chosen);
  }

  /// Names each group by its first sample.
  void name_by_first(const Sets& groups) {
    members_ = {};
    for (const Set set : groups) {
      if (set != 0) members_[first_of(set)] = set;
    }
  }

  /// The means of the groups' insides.
  PerSample<glm::vec3> means_inside() const {
    PerSample<glm::vec3> means{};
    for (std::size_t h = 0; h < count_; ++h) {
      if (members_[h] == 0) continue;
      glm::vec3 sum{0};
      for (Set left = members_[h]; left != 0; left = rest_of(left))
        sum += insides_[first_of(left)] - insides_[0];
      means[h] = sum * (1.0F / static_cast<float>(size_of(members_[h])));
    }
    return means;
  }

  /// Notes which known fingers look like one with another in this frame, and which ones look like several. Parts of a
  /// known finger that may not part are joined.
  void hold() {
    const PerSample<glm::vec3> means = means_inside();
    const PerSample<WhichKnown> label = labels_of_groups();
    const PartsOfKnown parts = parts_of_known(label);
    const Set palms = groups_of_palms();
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b) {
        if (!are_two_known(label[a], label[b])) continue;
        if (are_apart(a, b, square_apart(means[a], means[b]), palms, true)) continue;
        doubts_[*label[a]].apart = true;
        doubts_[*label[b]].apart = true;
      }
    }
    Sets chosen{};
    for (std::size_t h = 0; h < count_; ++h) {
      if (members_[h] == 0) continue;
      std::size_t to = h;
      if (label[h] && parts.count[*label[h]] > 1) {
        doubts_[*label[h]].several = true;
        if (!fingers_.may_part(*label[h])) to = parts.first[*label[h]];
      }
      chosen[to] |= members_[h];
    }
    name_by_first(chosen);
  }

  /// Whether a group is longer than any finger, or wider across its longest line: it is part of a palm or of the back
  /// of a hand.
  bool is_of_palm(std::size_t head) const {
    InplaceVector<glm::vec3, most_samples> places;
    for (Set left = members_[head]; left != 0; left = rest_of(left))
      places.push_back(samples_[first_of(left)].position);
    float longest = 0;
    glm::vec3 line(0);
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const float square = square_apart(places[i], places[k]);
        if (square <= longest) continue;
        longest = square;
        line = places[i] - places[k];
      }
    }
    return longest > square_of(most_length * width_) || width_across(places, line) > most_width * width_;
  }
  Set groups_of_palms() const {
    Set palms = 0;
    for (std::size_t h = 0; h < count_; ++h) {
      if (members_[h] != 0 && is_of_palm(h)) palms |= only(h);
    }
    return palms;
  }

  /// Joins parts between which no valley is seen, or whose insides are the same, and whatever continues a palm. The
  /// nearest parts come first.
  void settle() {
    for (;;) {
      const Set palms = groups_of_palms();
      const PerSample<glm::vec3> means = means_inside();
      const PerSample<WhichKnown> label = labels_of_groups();
      std::optional<float> nearest;
      std::size_t keeps = 0, goes = 0;
      for (std::size_t a = 0; a < count_; ++a) {
        for (std::size_t b = a + 1; b < count_ && members_[a] != 0; ++b) {
          if (members_[b] == 0) continue;
          const float square = square_apart(means[a], means[b]);
          const bool apart = are_two_known(label[a], label[b]);
          if (nearest && square >= *nearest) continue;
          if (apart && !(fingers_.may_meet(*label[a]) && fingers_.may_meet(*label[b]))) continue;
          if (are_apart(a, b, square, palms, apart)) continue;
          nearest = square;
          keeps = a;
          goes = b;
        }
      }
      if (!nearest) return;
      join(keeps, goes);
    }
  }

  const SkinSamples& samples_;
  const KnownLabels& labels_;
  const Known& fingers_;  ///< of the frame before
  std::size_t count_;
  float width_;
  PerSample<glm::vec3> insides_{};
  /// Sets of other samples, per sample. looked_: a camera that sees both gives evidence. valley_: a camera sees a
  /// valley between both. After all evidence, known_: there is any evidence; two_: the evidence says two fingers.
  /// same_: both have the same inside.
  Sets looked_{}, valley_{}, known_{}, two_{}, same_{};
  Sets kin_{}, strangers_{};  ///< of the same known finger, of another known finger
  Sets members_{};            ///< members of the group that begins with that sample
  std::array<Doubt, max_fingers> doubts_{};
};

}  // namespace

Parts find_parts(const Sight& sight, const SkinSamples& samples, float finger_width, const KnownLabels& labels,
                 const Known& known) {
  return Grouping(sight, samples, finger_width, labels, known).result();
}

}  // namespace palpa::touch
