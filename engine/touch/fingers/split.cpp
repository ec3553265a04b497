#include "touch/fingers/split.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/system/parallel.hpp"
#include "touch/fingers/known.hpp"
#include "touch/fingers/parts.hpp"

namespace palpa::touch {
namespace {

/// Clusters of a known finger are examined from this share of the greatest width of a finger on.
constexpr float known_wide = 0.8F;

/// Whether a surface supports a cluster: half of its sampled contacts are firm. A known finger needs half of that.
bool is_supported(const Sight& sight, const Touch& touch, const Finger& finger, bool known) {
  const SampledContacts sampled = sample_contacts(touch, finger);
  const auto seen = static_cast<std::uint32_t>(sampled.size());
  const auto firm = static_cast<std::uint32_t>(
      std::ranges::count_if(sampled, [&](std::uint32_t i) { return is_firm(sight, touch.contacts[i].point); }));
  return (known ? 4 : 2) * firm >= seen;
}

/// Whether samples of two known fingers are in it.
bool holds_several(const KnownLabels& labels) {
  WhichKnown first;
  for (const WhichKnown& label : labels) {
    if (!label) continue;
    if (first && label != first) return true;
    first = label;
  }
  return false;
}

bool is_wide(const SkinSamples& samples, float width) {
  return std::ranges::any_of(samples, [&](const SkinSample& a) {
    return std::ranges::any_of(
        samples, [&](const SkinSample& b) { return square_apart(a.position, b.position) > width * width; });
  });
}

/// In metres. 0 if nothing is to be split.
float splitting_width(const FingerOptions& parameters) {
  return parameters.cluster == Cluster::inside ? 0 : static_cast<float>(parameters.finger_width_m);
}

using PerPart = std::array<std::uint32_t, most_samples>;

/// The number of contacts that a part needs of which `finger` is the known finger, if any.
std::uint32_t least_of(const FingerOptions& parameters, const Known& known, const WhichKnown& finger) {
  return least_contacts(parameters.min_points, known.rules.few && finger);
}

/// Fills `wide`: the parts of a cluster, and the part of each of its contacts: that of its nearest sample.
void assign_parts(const Sight& sight, const Touch& touch, const FingerSkin& skin, const Known& known, float width,
                  SplitWork::Wide& wide) {
  const bool by_insides = known.rules.apart;
  const SkinSamples& samples = skin.samples;
  wide.parts = find_parts(sight, samples, width, by_insides ? skin.labels : KnownLabels(samples.size(), {}), known);
  wide.counts = {};
  wide.part_of.clear();
  if (!wide.parts.several()) return;
  for (const std::uint32_t i : touch.fingers[wide.finger].contacts) {
    SkinSample here{touch.contacts[i].position, glm::vec3(0)};
    if (by_insides) here.normal = normal_at(sight, touch.contacts[i].point);
    const bool has_inside = glm::dot(here.normal, here.normal) > 0;
    const glm::vec3 p = has_inside ? inside_of(here, width) : here.position;
    std::size_t nearest = 0;
    float nearest_square = 3.0e38F;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const float square = square_apart(p, has_inside ? wide.parts.insides[s] : samples[s].position);
      if (square >= nearest_square) continue;
      nearest_square = square;
      nearest = s;
    }
    wide.part_of.push_back(wide.parts.part[nearest]);
    ++wide.counts[wide.parts.part[nearest]];
  }
}

/// Gives the contacts of parts that are too small to be fingers to the largest part of the same known finger.
void keep_whole(const FingerOptions& parameters, const Known& known, SplitWork::Wide& wide) {
  std::array<std::uint8_t, most_samples> to{};
  for (std::size_t part = 0; part < most_samples; ++part) {
    to[part] = static_cast<std::uint8_t>(part);
    const WhichKnown finger = wide.parts.known[part];
    if (wide.counts[part] == 0 || !finger || wide.counts[part] >= least_of(parameters, known, finger)) continue;
    for (std::size_t other = 0; other < most_samples; ++other) {
      if (wide.parts.known[other] == finger && wide.counts[other] > wide.counts[to[part]])
        to[part] = static_cast<std::uint8_t>(other);
    }
  }
  wide.counts = {};
  for (std::uint8_t& part : wide.part_of) {
    part = to[part];
    ++wide.counts[part];
  }
}

/// Sorts the contacts of a finger by their parts, to the end of `sorted`. Returns where each part begins.
PerPart sort_by_parts(const Finger& finger, const SplitWork::Wide& wide, std::vector<std::uint32_t>& sorted) {
  PerPart begins{};
  auto next = static_cast<std::uint32_t>(sorted.size());
  for (std::size_t part = 0; part < most_samples; ++part) {
    begins[part] = next;
    next += wide.counts[part];
  }
  sorted.resize(next);
  PerPart places = begins;
  for (std::size_t k = 0; k < wide.part_of.size(); ++k)
    sorted[places[wide.part_of[k]]++] = finger.contacts[k];
  return begins;
}

/// One frame's work, in the order of its steps.
struct Splitting {
  const Sight& sight;
  const FingerOptions& parameters;
  const Known& known;
  Touch& out;
  FingerSkins& skins;
  SplitWork& work;
  float width = splitting_width(parameters);
  std::array<bool, max_fingers> dropped{};
  bool changed = false;

  void look() {
    work.wide_count = 0;
    for (std::uint32_t f = 0; f < out.finger_count; ++f) {
      const FingerSkin& skin = skins[f] = look_at(sight, known, out, out.fingers[f]);
      dropped[f] = !is_supported(sight, out, out.fingers[f], known.rules.few && skin.known);
      if (!dropped[f] && may_be_several(skin)) work.wide[work.wide_count++].finger = f;
      changed = changed || dropped[f];
    }
  }
  bool may_be_several(const FingerSkin& skin) const {
    const bool apart = known.rules.apart;
    const float widest = apart && skin.known ? known_wide * width : width;
    return width > 0 && (is_wide(skin.samples, widest) || (apart && holds_several(skin.labels)));
  }

  void find_all_parts() {
    const auto find = [&](std::size_t, std::size_t begin, std::size_t end) {
      for (SplitWork::Wide& wide : std::span(work.wide).subspan(begin, end - begin)) {
        assign_parts(sight, out, skins[wide.finger], known, width, wide);
        if (known.rules.whole && wide.parts.several()) keep_whole(parameters, known, wide);
      }
    };
    // Other threads cost more than they gain for the few clusters of a hand.
    constexpr std::uint32_t many = 4;
    work.wide_count >= many ? parallel_chunks(work.wide_count, 1, find) : find(0, 0, work.wide_count);
    for (const SplitWork::Wide& wide : work.wide_now()) {
      for (std::uint32_t k = 0; known.table != nullptr && k < max_fingers; ++k)
        known.doubt(k, wide.parts.doubts[k]);
    }
  }

  /// Lists the clusters after the split; of parts, also the contacts.
  void list_clusters() {
    work.clusters.clear();
    work.contacts.clear();
    const SplitWork::Wide* wide = work.wide.data();
    const SplitWork::Wide* const end = wide + work.wide_count;
    for (std::uint32_t f = 0; f < out.finger_count; ++f) {
      const Finger& finger = out.fingers[f];
      const bool is_wide = wide != end && wide->finger == f;
      if (is_wide && wide->parts.several()) {
        list_parts(finger, *wide);
      } else if (!dropped[f]) {
        work.clusters.push_back({finger.contacts.front(), finger.solid, f, 0, finger.contact_count});
      }
      if (is_wide) ++wide;
    }
  }
  void list_parts(const Finger& finger, const SplitWork::Wide& wide) {
    changed = true;
    const PerPart begins = sort_by_parts(finger, wide, work.contacts);
    for (std::size_t part = 0; part < most_samples; ++part) {
      const std::uint32_t size = wide.counts[part];
      if (size == 0 || size < least_of(parameters, known, wide.parts.known[part])) continue;
      work.clusters.push_back({work.contacts[begins[part]], finger.solid, {}, begins[part], size});
    }
  }

  /// The clusters become the fingers. If there are too many, the largest stay.
  void take_clusters() {
    for (SplitWork::Cluster& cluster : work.clusters) {
      if (!cluster.finger) continue;
      const std::vector<std::uint32_t>& all = out.fingers[*cluster.finger].contacts;
      cluster.begin = static_cast<std::uint32_t>(work.contacts.size());
      work.contacts.insert(work.contacts.end(), all.begin(), all.end());
    }
    const auto found = static_cast<std::uint32_t>(work.clusters.size());
    if (found > max_fingers) {
      std::ranges::sort(work.clusters, [](const SplitWork::Cluster& a, const SplitWork::Cluster& b) {
        return a.count != b.count ? a.count > b.count : a.first < b.first;
      });
      work.clusters.resize(max_fingers);
    }
    std::ranges::sort(work.clusters, {}, &SplitWork::Cluster::first);
    out.cluster_count = out.cluster_count - out.finger_count + found;
    out.finger_count = std::min(found, max_fingers);
    if (out.fingers.size() < out.finger_count) out.fingers.resize(out.finger_count);
    for (std::uint32_t f = 0; f < out.finger_count; ++f)
      take_cluster(f, work.clusters[f]);
    std::swap(work.skins, skins);
  }
  void take_cluster(std::uint32_t f, const SplitWork::Cluster& cluster) {
    const auto contacts = std::span(work.contacts).subspan(cluster.begin, cluster.count);
    Finger& finger = out.fingers[f];
    finger.solid = cluster.solid;
    finger.contact_count = cluster.count;
    finger.contacts.assign(contacts.begin(), contacts.end());
    work.skins[f] = cluster.finger ? skins[*cluster.finger] : look_at(sight, known, out, finger);
  }
};

}  // namespace

SplitWork::SplitWork() : skins(max_fingers), wide(max_fingers) {
  clusters.reserve(std::size_t{max_fingers} * most_samples);
}

void split_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known, Touch& out,
                   FingerSkins& skins, SplitWork& work) {
  Splitting splitting{sight, parameters, known, out, skins, work};
  splitting.look();
  splitting.find_all_parts();
  splitting.list_clusters();
  if (splitting.changed) splitting.take_clusters();
}

}  // namespace palpa::touch
