#include "touch/fingers/split.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "touch/fingers/known.hpp"
#include "touch/fingers/split_math.hpp"

namespace palpa::touch {
namespace {

constexpr std::size_t most = bridge_samples;
using Set = std::uint64_t;  ///< of samples
using Sets = std::array<Set, most>;

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

bool are_two_known(std::uint32_t one, std::uint32_t other) {
  return one != known_none && other != known_none && one != other;
}

bool is_valley_between(const Sight& sight, std::size_t c, const SplitView& a, const SplitView& b) {
  const BridgeCamera& camera = sight.cameras[c];
  SplitWalk walk = walk_between(a, b);
  if (walk.steps == 0) return false;
  for (std::uint32_t s = 0; s <= walk.steps && walk.state != split_valley; ++s) {
    const std::uint32_t raw =
        raw_at(sight, c, pixel_between(a.u, b.u, s, walk.steps), pixel_between(a.v, b.v, s, walk.steps));
    walk = raw < camera.first_depth ? walked_hole(walk)
                                    : walked(walk, line_depth(a.at.z, b.at.z, s, walk.steps),
                                             product(static_cast<float>(raw), camera.depth_unit));
  }
  return walk.state == split_valley;
}

/// Assigns the samples of a wide cluster to fingers.
class Parts {
 public:
  /// `labels`: the samples' known fingers.
  Parts(const Sight& sight, const SkinSamples& samples, float finger_width, const KnownLabels& labels,
        const Known& known)
      : samples_(samples), labels_(labels), fingers_(known), count_(samples.size()), width_(finger_width) {
    for (std::size_t c = 0; c < sight.cameras.size(); ++c)
      look(sight, c);
    known_ = looked_;
    two_ = valley_;
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = 0; b < count_; ++b) {
        if (labels_[a] == known_none) continue;
        if (labels_[b] == labels_[a]) kin_[a] |= only(b);
        if (labels_[b] != labels_[a] && labels_[b] != known_none) strangers_[a] |= only(b);
      }
    }
    compare();
    for (std::size_t s = 0; s < count_; ++s)
      members_[s] = only(s);
    grow();
    for (std::uint32_t round = 0; round < split_votes; ++round)
      vote();
    settle();
    hold();
    return_home();
  }

  /// The part of a sample: its first sample.
  std::size_t head(std::size_t s) const {
    std::size_t h = 0;
    while ((members_[h] & only(s)) == 0)
      ++h;
    return h;
  }
  const Float3& inside(std::size_t s) const { return insides_[s]; }
  /// Whether most of a part's samples with a known finger have the same one.
  bool is_known(std::size_t head) const { return label_of(head) != known_none; }
  bool several() const {
    return std::count_if(members_.begin(), members_.end(), [](Set set) { return set != 0; }) > 1;
  }

 private:
  void look(const Sight& sight, std::size_t c) {
    std::array<SplitView, most> views{};
    for (std::size_t s = 0; s < count_; ++s) {
      const Appearance a = appearance(sight.cameras[c], samples_[s].position);
      views[s] = split_view(sight.cameras[c], a, raw_at(sight, c, a.u, a.v), samples_[s].position);
    }
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b) {
        if (!views[a].seen || !views[b].seen) continue;
        looked_[a] |= only(b);
        looked_[b] |= only(a);
        // One camera that sees a valley is enough.
        if ((valley_[a] & only(b)) != 0 || !is_valley_between(sight, c, views[a], views[b])) continue;
        valley_[a] |= only(b);
        valley_[b] |= only(a);
      }
    }
  }

  /// Adds the evidence of the samples' normals to that of the skin seen between them.
  void compare() {
    for (std::size_t s = 0; s < count_; ++s)
      insides_[s] = inside_of(samples_[s].position, samples_[s].normal, width_);
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b) {
        const bool same = one_inside(insides_[a], insides_[b], width_);
        // Samples of two known fingers are evidence for two.
        if (!same && (strangers_[a] & only(b)) == 0 &&
            !face_each_other(samples_[a].position, samples_[a].normal, samples_[b].position, samples_[b].normal))
          continue;
        for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
          known_[one] |= only(other);
          two_[one] = same ? two_[one] & ~only(other) : two_[one] | only(other);
          same_[one] |= same ? only(other) : 0;
        }
      }
    }
  }

  SplitLink link_between(std::size_t a, std::size_t b, const Sets& known, const Sets& two) const {
    SplitLink link{0, 0};
    for (Set left = members_[a]; left != 0; left = rest_of(left)) {
      link.known += size_of(known[first_of(left)] & members_[b]);
      link.two += size_of(two[first_of(left)] & members_[b]);
    }
    return link;
  }

  /// The known finger of most samples of a group; if two have equally many, that of the first sample.
  std::uint32_t label_of(std::size_t head) const {
    std::uint32_t most_kin = 0, label = known_none;
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
  std::array<std::uint32_t, most> labels_of_groups() const {
    std::array<std::uint32_t, most> labels{};
    for (std::size_t h = 0; h < count_; ++h)
      labels[h] = members_[h] != 0 ? label_of(h) : known_none;
    return labels;
  }

  void join(std::size_t a, std::size_t b) {
    members_[a] |= members_[b];
    members_[b] = 0;
  }

  /// Grows groups of samples, the most certain pair first.
  void grow() {
    std::array<std::array<SplitLink, most>, most> links{};
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b)
        links[a][b] = links[b][a] = link_between(a, b, known_, two_);
    }
    for (;;) {
      const SplitLink* surest = nullptr;
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
        SplitLink& link = links[keeps][other];
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

  /// Moves each sample of a known finger to the part of most of that finger's samples, if there is only one. So the
  /// border between two known fingers does not depend on which contacts happen to be samples.
  void return_home() {
    std::array<std::uint32_t, max_fingers> parts{};
    std::array<std::size_t, max_fingers> part{};
    const std::array<std::uint32_t, most> labels = labels_of_groups();
    for (std::size_t h = count_; h-- > 0;) {
      if (labels[h] == known_none) continue;
      ++parts[labels[h]];
      part[labels[h]] = h;
    }
    Sets chosen{};
    for (std::size_t s = 0; s < count_; ++s) {
      const std::uint32_t label = labels_[s];
      chosen[label != known_none && parts[label] == 1 ? part[label] : head(s)] |= only(s);
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
  std::array<Float3, most> means_inside() const {
    std::array<Float3, most> means{};
    for (std::size_t h = 0; h < count_; ++h) {
      if (members_[h] == 0) continue;
      Float3 sum{0, 0, 0};
      for (Set left = members_[h]; left != 0; left = rest_of(left))
        sum = plus(sum, minus(insides_[first_of(left)], insides_[0]));
      means[h] = scaled(sum, 1.0F / static_cast<float>(size_of(members_[h])));
    }
    return means;
  }

  /// Notes which known fingers look like one with another in this frame, and which ones look like several. Parts of a
  /// known finger that may not part are joined.
  void hold() {
    const std::array<Float3, most> means = means_inside();
    const std::array<std::uint32_t, most> label = labels_of_groups();
    std::array<std::uint32_t, max_fingers> parts{};
    std::array<std::size_t, max_fingers> part{};
    for (std::size_t h = count_; h-- > 0;) {
      if (label[h] == known_none) continue;
      ++parts[label[h]];
      part[label[h]] = h;
    }
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = a + 1; b < count_; ++b) {
        if (!are_two_known(label[a], label[b])) continue;
        if (are_fingers(link_between(a, b, looked_, valley_), square_apart(means[a], means[b]), width_, true)) continue;
        fingers_.doubt(label[a], doubt_apart);
        fingers_.doubt(label[b], doubt_apart);
      }
    }
    Sets chosen{};
    for (std::size_t h = 0; h < count_; ++h) {
      if (members_[h] == 0) continue;
      std::size_t to = h;
      if (label[h] != known_none && parts[label[h]] > 1) {
        fingers_.doubt(label[h], doubt_one);
        if (!fingers_.may_part(label[h])) to = part[label[h]];
      }
      chosen[to] |= members_[h];
    }
    name_by_first(chosen);
  }

  /// Joins parts between which no valley is seen, or whose insides are the same. The nearest parts come first.
  void settle() {
    for (;;) {
      const std::array<Float3, most> means = means_inside();
      const std::array<std::uint32_t, most> label = labels_of_groups();
      std::optional<float> nearest;
      std::size_t keeps = 0, goes = 0;
      for (std::size_t a = 0; a < count_; ++a) {
        for (std::size_t b = a + 1; b < count_ && members_[a] != 0; ++b) {
          if (members_[b] == 0) continue;
          const float square = square_apart(means[a], means[b]);
          const bool apart = are_two_known(label[a], label[b]);
          if (are_fingers(link_between(a, b, looked_, valley_), square, width_, apart)) continue;
          if (apart && !(fingers_.may_meet(label[a]) && fingers_.may_meet(label[b]))) continue;
          if (nearest && square >= *nearest) continue;
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
  const KnownLabels labels_;
  const Known& fingers_;  ///< of the frame before
  std::size_t count_;
  float width_;
  std::array<Float3, most> insides_{};
  /// Sets of other samples, per sample. looked_: a camera that sees both gives evidence. valley_: a camera sees a
  /// valley between both. After all evidence, known_: there is any evidence; two_: the evidence says two fingers.
  /// same_: both have the same inside.
  Sets looked_{}, valley_{}, known_{}, two_{}, same_{};
  Sets kin_{}, strangers_{};  ///< of the same known finger, of another known finger
  Sets members_{};            ///< members of the group that begins with that sample
};

bool is_firm(const Sight& sight, std::uint32_t point) {
  const SeenPixel p = pixel_of(sight, point);
  const BridgeCamera& camera = sight.cameras[p.camera];
  const auto depth_of = [&](std::uint32_t raw) { return product(static_cast<float>(raw), camera.depth_unit); };
  const float at = depth_of(raw_at(sight, p.camera, p.u, p.v));
  constexpr std::uint32_t reach = split_reach;
  std::uint32_t near = 0;
  for (std::uint32_t v = p.v; v < p.v + split_window; ++v) {
    for (std::uint32_t u = p.u; u < p.u + split_window; ++u) {  // both too large by `reach`
      if (u < reach || v < reach || u - reach >= camera.width || v - reach >= camera.height) continue;
      const std::uint32_t raw = raw_at(sight, p.camera, u - reach, v - reach);
      if (raw >= camera.first_depth && is_near(at, depth_of(raw))) ++near;
    }
  }
  return near >= PALPA_TUNED(company, split_company);
}

bool is_supported(const Sight& sight, const Touch& touch, const Finger& finger, bool known) {
  const SampledContacts sampled = sample_contacts(finger);
  const auto firm = std::count_if(sampled.begin(), sampled.end(),
                                  [&](std::uint32_t i) { return is_firm(sight, touch.contacts[i].point); });
  return supported(static_cast<std::uint32_t>(sampled.size()), static_cast<std::uint32_t>(firm), known);
}

/// Whether samples of two known fingers are in it.
bool holds_several(const KnownLabels& labels) {
  std::uint32_t first = known_none;
  for (const std::uint32_t label : labels) {
    if (label == known_none) continue;
    if (first != known_none && label != first) return true;
    first = label;
  }
  return false;
}

bool is_wide(const SkinSamples& samples, float finger_width) {
  for (const SkinSample& a : samples) {
    for (const SkinSample& b : samples) {
      if (square_apart(a.position, b.position) > product(finger_width, finger_width)) return true;
    }
  }
  return false;
}

/// In metres. 0 if nothing is to be split.
float splitting_width(const Parameters& parameters) {
  return parameters.cluster == Cluster::inside ? 0 : static_cast<float>(parameters.finger_width_m);
}

/// The part of each contact of a finger: that of its nearest sample. Returns how many contacts each part has.
std::array<std::uint32_t, most> find_heads(const Sight& sight, const Touch& touch, const Finger& finger,
                                           const SkinSamples& samples, const Parts& parts, bool by_insides, float width,
                                           std::vector<std::uint8_t>& heads) {
  std::array<std::size_t, most> head_of{};
  for (std::size_t s = 0; s < samples.size(); ++s)
    head_of[s] = parts.head(s);
  std::array<std::uint32_t, most> counts{};
  heads.clear();
  for (const std::uint32_t i : finger.contacts) {
    const glm::vec3& position = touch.contacts[i].position;
    Float3 p{position.x, position.y, position.z};
    const Float3 normal = by_insides ? normal_at(sight, touch.contacts[i].point) : Float3{0, 0, 0};
    const bool has_inside = dot3(normal, normal) > 0;
    if (has_inside) p = inside_of(p, normal, width);
    std::size_t nearest = 0;
    float nearest_square = 3.0e38F;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const float square = square_apart(p, has_inside ? parts.inside(s) : samples[s].position);
      if (square >= nearest_square) continue;
      nearest_square = square;
      nearest = s;
    }
    heads.push_back(static_cast<std::uint8_t>(head_of[nearest]));
    ++counts[head_of[nearest]];
  }
  return counts;
}

/// Sorts the contacts of a finger by their parts, to the end of `sorted`. Returns where each part begins.
std::array<std::uint32_t, most> sort_by_parts(const Finger& finger, const std::array<std::uint32_t, most>& counts,
                                              const std::vector<std::uint8_t>& heads,
                                              std::vector<std::uint32_t>& sorted) {
  std::array<std::uint32_t, most> begins{};
  auto next = static_cast<std::uint32_t>(sorted.size());
  for (std::size_t head = 0; head < most; ++head) {
    begins[head] = next;
    next += counts[head];
  }
  sorted.resize(next);
  std::array<std::uint32_t, most> places = begins;
  for (std::size_t k = 0; k < heads.size(); ++k)
    sorted[places[heads[k]]++] = finger.contacts[k];
  return begins;
}

}  // namespace

SplitWork::SplitWork() {
  clusters.reserve(std::size_t{max_fingers} * most);
}

void split_fingers(const Sight& sight, const Parameters& parameters, const Known& known, Touch& out, SplitWork& work) {
  const float width = splitting_width(parameters);
  const std::uint32_t count = out.finger_count;
  const bool apart = (known.rules & known_apart) != 0;
  bool changed = false;
  work.clusters.clear();
  work.contacts.clear();
  for (std::uint32_t f = 0; f < count; ++f) {
    const Finger& finger = out.fingers[f];
    const SkinSamples samples = sample_skin(sight, out, finger);
    const KnownLabels labels = known_labels(known, finger.solid, samples);
    const bool is_known = known_majority(labels) != known_none;
    if (!is_supported(sight, out, finger, known.has(known_few) && is_known)) {
      changed = true;
      continue;
    }
    const auto stays = [&] {
      work.clusters.push_back({finger.contacts.front(), finger.solid, f, 0, finger.contact_count});
    };
    const float widest = product(apart && is_known ? PALPA_SPLIT_KNOWN_WIDE : 1.0F, width);
    if (!(width > 0) || !(is_wide(samples, widest) || (apart && holds_several(labels)))) {
      stays();
      continue;
    }
    const Parts parts(sight, samples, width, apart ? labels : KnownLabels(samples.size(), known_none), known);
    if (!parts.several()) {
      stays();
      continue;
    }
    changed = true;
    const auto counts = find_heads(sight, out, finger, samples, parts, apart, width, work.heads);
    const auto begins = sort_by_parts(finger, counts, work.heads, work.contacts);
    for (std::size_t head = 0; head < most; ++head) {
      if (counts[head] == 0) continue;
      const bool goes_on = known.has(known_few) && parts.is_known(head);
      if (counts[head] < least_contacts(parameters.min_points, goes_on)) continue;
      work.clusters.push_back(
          {work.contacts[begins[head]], finger.solid, SplitWork::is_part, begins[head], counts[head]});
    }
  }
  if (!changed) return;
  for (SplitWork::Cluster& cluster : work.clusters) {
    if (cluster.finger == SplitWork::is_part) continue;
    const std::vector<std::uint32_t>& all = out.fingers[cluster.finger].contacts;
    cluster.begin = static_cast<std::uint32_t>(work.contacts.size());
    work.contacts.insert(work.contacts.end(), all.begin(), all.end());
  }
  std::ranges::sort(work.clusters, {}, &SplitWork::Cluster::first);
  const auto found = static_cast<std::uint32_t>(work.clusters.size());
  out.cluster_count = out.cluster_count - count + found;
  out.finger_count = std::min(found, max_fingers);
  if (out.fingers.size() < out.finger_count) out.fingers.resize(out.finger_count);
  for (std::uint32_t f = 0; f < out.finger_count; ++f) {
    const SplitWork::Cluster& cluster = work.clusters[f];
    const auto contacts = std::span(work.contacts).subspan(cluster.begin, cluster.count);
    out.fingers[f].solid = cluster.solid;
    out.fingers[f].contact_count = cluster.count;
    out.fingers[f].contacts.assign(contacts.begin(), contacts.end());
  }
}

}  // namespace palpa::touch
