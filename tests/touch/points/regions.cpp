#include "touch/points/regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nanoflann.hpp>
#include <utility>

#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

/// What nanoflann asks of a cloud.
struct Cloud {
  const std::vector<Contact>& contacts;
  std::size_t kdtree_get_point_count() const { return contacts.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return contacts[i].position[static_cast<int>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;

/// Collects what a search meets. nanoflann's own collectors have other types in 1.4 than from 1.5 on; what it asks of
/// one is the same.
struct Near {
  using DistanceType = double;

  double square;
  std::vector<std::uint32_t> found;

  bool addPoint(double distance, std::uint32_t index) {
    if (distance < square) found.push_back(index);
    return true;
  }
  std::size_t size() const { return found.size(); }
  bool empty() const { return found.empty(); }
  bool full() const { return true; }
  double worstDist() const { return square; }
  void sort() {}
};

}  // namespace

// The tree gives candidates in double precision, a little too many; whether two contacts are together is decided as the
// contract states it.
Regions grow_regions(const std::vector<Contact>& contacts, double gap_m) {
  if (contacts.empty()) return {};
  const float gap = static_cast<float>(gap_m), limit = gap * gap;
  const Cloud cloud{contacts};
  Tree tree(3, cloud);
  tree.buildIndex();
  Regions regions;
  std::vector<bool> taken(contacts.size(), false);
  for (std::uint32_t seed = 0; seed < contacts.size(); ++seed) {
    if (taken[seed]) continue;
    std::vector<std::uint32_t> region{seed};
    taken[seed] = true;
    for (std::size_t next = 0; next < region.size(); ++next) {
      const Contact& from = contacts[region[next]];
      const std::array<double, 3> query{from.position.x, from.position.y, from.position.z};
      Near near{double{limit} * (1 + 1e-6), {}};
      tree.radiusSearchCustomCallback(query.data(), near);
      for (const std::uint32_t i : near.found) {
        const glm::vec3 d = contacts[i].position - from.position;
        if (taken[i] || contacts[i].solid != from.solid || d.x * d.x + d.y * d.y + d.z * d.z > limit) continue;
        taken[i] = true;
        region.push_back(i);
      }
    }
    std::sort(region.begin(), region.end());
    regions.push_back(std::move(region));
  }
  return regions;
}

std::string not_regions(const Touch& touch, const FingerOptions& parameters) {
  std::vector<Contact> all = touch.contacts;
  if (parameters.cluster == Cluster::inside) all.insert(all.end(), touch.deep.begin(), touch.deep.end());
  Regions expected = grow_regions(all, parameters.finger_gap_m);
  for (std::vector<std::uint32_t>& region : expected)
    std::erase_if(region, [&](std::uint32_t i) { return i >= touch.contacts.size(); });
  std::erase_if(expected, [&](const auto& region) { return region.size() < std::max(parameters.min_points, 1U); });
  if (touch.cluster_count != expected.size())
    return fmt::format("{} clusters, not {}", touch.cluster_count, expected.size());
  expected = largest(std::move(expected));
  if (touch.finger_count != expected.size())
    return fmt::format("{} fingers, not {}", touch.finger_count, expected.size());
  for (std::size_t f = 0; f < expected.size(); ++f) {
    const Finger& finger = touch.fingers[f];
    if (finger.contacts != expected[f] || finger.contact_count != expected[f].size() ||
        finger.solid != touch.contacts[expected[f].front()].solid)
      return fmt::format("finger {} is another one", f);
  }
  return "";
}

}  // namespace palpa::touch::test
