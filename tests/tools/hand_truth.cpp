#include "hand_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <nanoflann.hpp>
#include <numeric>
#include <set>

#include "touch/types.hpp"

namespace palpa::test {
namespace {

const touch::FingerOptions usual;
/// Skin so little above a surface, the sensor's noise brings into the shell.
constexpr double noisy_m = 0.3e-3;

/// Sets of contacts that continue each other.
struct Sets {
  std::vector<std::size_t> parent;
  explicit Sets(std::size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), std::size_t{0}); }
  std::size_t of(std::size_t i) {
    while (parent[i] != i)
      i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent[of(a)] = of(b); }
};

}  // namespace

/// Finds the nearest vertex of a skin.
struct HandTruth::Finder {
  struct Points {
    const std::vector<Vec3>& all;
    std::size_t kdtree_get_point_count() const { return all.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const { return all[i][static_cast<int>(axis)]; }
    template <class Bounds>
    bool kdtree_get_bbox(Bounds&) const {
      return false;
    }
  };
  using Metric = nanoflann::L2_Simple_Adaptor<double, Points>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Points, 3, std::size_t>;

  Points points;
  Tree tree;
  explicit Finder(const HandSkin& skin)
      : points{skin.mesh.positions}, tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    tree.buildIndex();
  }
  std::size_t nearest(const Vec3& local, double& square) const {
    std::size_t index = 0;
    const std::array<double, 3> place{local.x, local.y, local.z};
    tree.knnSearch(place.data(), 1, &index, &square);
    return index;
  }
};

HandTruth::HandTruth(const RatedHand& hand)
    : hand_(hand),
      rig_(hand.cameras, {}, sensing::Noise::none, 0),
      stage_(hand.solids, hand.cameras, {.parameters = {.finger_width_m = 0}}) {
  for (const HandBody& body : hand.bodies)
    finders_.push_back(std::make_unique<Finder>(*body.skin));
}
HandTruth::~HandTruth() = default;

TrueFrame HandTruth::depths_at(double time_s) const {
  TrueFrame frame;
  frame.depth_m.assign(hand_.parts(), -1);
  Box near;
  for (const geometry::Solid& solid : hand_.solids) {
    near.add(solid.bounds.low - 2e-3);
    near.add(solid.bounds.high + 2e-3);
  }
  for (const HandBody& body : hand_.bodies) {
    const Transform T = body.pose(time_s);
    frame.T_world_body.push_back(T);
    frame.T_body_world.push_back(glm::inverse(T));
    for (std::size_t i = 0; i < body.skin->part.size(); ++i) {
      const Vec3 p = transform_point(T, body.skin->mesh.positions[i]);
      if (p.y < near.low.y || p.y > near.high.y || p.x < near.low.x || p.x > near.high.x || p.z < near.low.z ||
          p.z > near.high.z)
        continue;
      double& deepest = frame.depth_m[body.first_part + body.skin->part[i]];
      for (const geometry::Solid& solid : hand_.solids)
        deepest = std::max(deepest, geometry::depth(solid, p));
    }
  }
  return frame;
}

const TrueFrame& HandTruth::at(double time_s) {
  if (counted_ && !hand_.moves) return frame_;
  frame_ = depths_at(time_s);
  count(frame_);
  counted_ = true;
  return frame_;
}

void HandTruth::count(TrueFrame& frame) {
  const std::uint32_t parts = hand_.parts();
  std::vector<sensing::Posed> posed;
  for (std::size_t b = 0; b < hand_.bodies.size(); ++b)
    posed.push_back({&hand_.bodies[b].skin->mesh, frame.T_world_body[b]});
  rig_.render(posed, 0, set_);
  stage_.touch(set_.frames, touch_);
  const std::vector<touch::Contact>& contacts = touch_.contacts;
  frame.contacts.assign(parts, 0);
  frame.centroid.assign(parts, Vec3(0));
  frame.of_palm.assign(parts, false);
  std::vector<std::uint32_t> part;
  for (const touch::Contact& contact : contacts) {
    part.push_back(part_at(frame, Vec3(contact.position)));
    ++frame.contacts[part.back()];
    frame.centroid[part.back()] += Vec3(contact.position);
  }
  for (std::uint32_t p = 0; p < parts; ++p)
    frame.centroid[p] /= std::max(frame.contacts[p], 1);
  // Contacts of a palm and of its own digits continue each other; those of two digits do not.
  std::vector<std::uint32_t> palm(parts, parts);  // of each part of a hand; single fingers have none
  for (const HandBody& body : hand_.bodies) {
    for (std::uint32_t p = 0; body.skin->parts == hand_parts && p < hand_parts; ++p)
      palm[body.first_part + p] = body.first_part + palm_part;
  }
  Sets sets(contacts.size());
  const double gap = usual.finger_gap_m;
  std::map<std::array<int, 3>, std::vector<std::size_t>> cells;
  const auto cell_of = [&](const glm::vec3& p) {
    return std::array{int(std::floor(p.x / gap)), int(std::floor(p.y / gap)), int(std::floor(p.z / gap))};
  };
  const auto continues = [&](std::uint32_t a, std::uint32_t b) {
    return a == b || (palm[a] != parts && palm[a] == palm[b] && (a == palm[a] || b == palm[b]));
  };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t own = palm[part[i]];
    if (own == parts || frame.contacts[own] == 0) continue;
    const auto cell = cell_of(contacts[i].position);
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (found == cells.end()) continue;
      for (const std::size_t j : found->second) {
        if (continues(part[i], part[j]) && sets.of(i) != sets.of(j) &&
            glm::distance(contacts[i].position, contacts[j].position) <= gap)
          sets.join(i, j);
      }
    }
    cells[cell].push_back(i);
  }
  struct Patch {
    std::uint32_t palm = 0;
    int contacts = 0;
    Vec3 sum{0};
    Vec3 mean() const { return sum / static_cast<double>(contacts); }
  };
  std::map<std::size_t, Patch> patches;  // sets with contacts of a palm
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (palm[part[i]] == part[i]) patches[sets.of(i)].palm = part[i];
  }
  std::vector<int> own(parts, 0);  // of the digits: contacts that do not continue the palm
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto at = patches.find(sets.of(i));
    if (at == patches.end()) {
      ++own[part[i]];
      continue;
    }
    ++at->second.contacts;
    at->second.sum += Vec3(contacts[i].position);
  }
  const int few = static_cast<int>(usual.min_points);
  frame.fingers = frame.least = frame.most = 0;
  for (std::uint32_t p = 0; p < parts; ++p) {
    if (palm[p] == p) continue;
    frame.fingers += own[p] >= few ? 1 : 0;
    frame.least += own[p] >= 2 * few ? 1 : 0;
    frame.most += own[p] > 0 || (frame.contacts[p] == 0 && frame.depth_m[p] > -noisy_m) ? 1 : 0;
    frame.of_palm[p] = frame.contacts[p] > 2 * own[p];
    if (!frame.of_palm[p]) continue;
    frame.depth_m[palm[p]] = std::max(frame.depth_m[palm[p]], frame.depth_m[p]);
    ++frame.most;
  }
  // Patches of one palm that are near each other are one.
  std::erase_if(patches, [&](const auto& patch) { return patch.second.contacts < few; });
  std::vector<const Patch*> apart;
  for (const auto& [set, patch] : patches) {
    const auto near = [&patch = patch](const Patch* other) {
      return other->palm == patch.palm && glm::distance(other->mean(), patch.mean()) <= usual.finger_width_m;
    };
    if (std::ranges::none_of(apart, near)) apart.push_back(&patch);
  }
  std::set<std::uint32_t> palms;
  for (const Patch* patch : apart)
    palms.insert(patch->palm);
  frame.fingers += static_cast<std::uint32_t>(apart.size());
  frame.least += static_cast<std::uint32_t>(palms.size());
  frame.most += static_cast<std::uint32_t>(patches.size());
}

std::uint32_t HandTruth::body_of(std::uint32_t part) const {
  std::uint32_t body = 0;
  while (body + 1 < hand_.bodies.size() && hand_.bodies[body + 1].first_part <= part)
    ++body;
  return body;
}

std::uint32_t HandTruth::part_at(const TrueFrame& frame, const Vec3& place) const {
  std::uint32_t part = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < hand_.bodies.size(); ++b) {
    double square = 0;
    const std::size_t vertex = finders_[b]->nearest(transform_point(frame.T_body_world[b], place), square);
    const Vec3 scale(frame.T_world_body[b][0]);
    square *= glm::dot(scale, scale);
    if (square >= least) continue;
    least = square;
    part = hand_.bodies[b].first_part + hand_.bodies[b].skin->part[vertex];
  }
  if (part < frame.of_palm.size() && frame.of_palm[part]) part = hand_.bodies[body_of(part)].first_part + palm_part;
  return part;
}

Vec3 HandTruth::way_of(std::uint32_t part, const Vec3& place, double from_s, double to_s) const {
  const HandBody& body = hand_.bodies[body_of(part)];
  if (!hand_.moves) return Vec3(0);
  return transform_point(body.pose(to_s) * glm::inverse(body.pose(from_s)), place) - place;
}

}  // namespace palpa::test
