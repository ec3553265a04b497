// Contacts sorted by cell, cells joined pair by pair.
#include "touch/fingers_twin.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <unordered_map>

#include "shaders/fingers_math.h"
#include "touch/finger_cells.hpp"

namespace palpa::touch {
namespace {

using shader::Float3;

struct Key {
  std::int32_t x, y, z;
  std::uint32_t solid;
  bool operator==(const Key&) const = default;
};

struct KeyHash {
  std::size_t operator()(const Key& k) const {
    std::uint64_t h = static_cast<std::uint32_t>(k.x) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ static_cast<std::uint32_t>(k.y)) * 0xc2b2ae3d27d4eb4fULL;
    h = (h ^ static_cast<std::uint32_t>(k.z)) * 0x165667b19e3779f9ULL;
    h = (h ^ k.solid) * 0x9e3779b97f4a7c15ULL;
    return h ^ h >> 32;
  }
};

struct Cell {
  Key key;
  std::uint32_t begin, end;  ///< in the contacts sorted by cell
};

std::uint32_t find_root(std::vector<std::uint32_t>& parents, std::uint32_t a) {
  while (parents[a] != a) {
    parents[a] = parents[parents[a]];
    a = parents[a];
  }
  return a;
}

Float3 position(const Contact& contact) {
  return {contact.position.x, contact.position.y, contact.position.z};
}

Key cell_of(const Contact& contact, const PreparedSolids& solids, float density) {
  const shader::vec4& centre = solids.records[contact.solid].centre;
  const auto along = [&](float p, float c) { return static_cast<std::int32_t>(std::floor((p - c) * density)); };
  return {along(contact.position.x, centre.x), along(contact.position.y, centre.y), along(contact.position.z, centre.z),
          contact.solid};
}

/// Finds each contact's cluster: its smallest contact.
class Clustering {
 public:
  Clustering(const std::vector<Contact>& contacts, const PreparedSolids& solids, float gap)
      : contacts_(contacts), limit_(gap * gap), smallest_(contacts.size()) {
    sort_into_cells(solids, cells_per_metre(gap));
    std::iota(smallest_.begin(), smallest_.end(), 0U);
    // Cells that touch first: most of the others are then in one cluster already.
    for (const int reach : {1, 2}) {
      for (const Cell& cell : cells_)
        link(cell, reach);
    }
    for (const Cell& cell : cells_) {
      const std::uint32_t root = find_root(smallest_, sorted_[cell.begin]);
      for (std::uint32_t k = cell.begin; k < cell.end; ++k)
        smallest_[sorted_[k]] = root;
    }
  }

  const std::vector<std::uint32_t>& smallest() const { return smallest_; }

 private:
  void sort_into_cells(const PreparedSolids& solids, float density) {
    std::vector<std::uint32_t> cell_of_contact;
    cell_of_contact.reserve(contacts_.size());
    for (const Contact& contact : contacts_) {
      const Key key = cell_of(contact, solids, density);
      const auto [at, fresh] = by_key_.try_emplace(key, static_cast<std::uint32_t>(cells_.size()));
      if (fresh) cells_.push_back({key, 0, 0});
      cell_of_contact.push_back(at->second);
      ++cells_[at->second].end;
    }
    std::uint32_t sum = 0;
    for (Cell& cell : cells_) {
      cell.begin = sum;
      sum += cell.end;
      cell.end = cell.begin;
    }
    sorted_.resize(contacts_.size());
    for (std::uint32_t i = 0; i < contacts_.size(); ++i)
      sorted_[cells_[cell_of_contact[i]].end++] = i;
  }

  /// Unites `cell` with the neighbours that lie `reach` cells away in the widest direction.
  void link(const Cell& cell, int reach) {
    for (int place = 63; place < 125; ++place) {  // one half of the 5x5x5 block
      const int x = place % 5 - 2, y = place / 5 % 5 - 2, z = place / 25 - 2;
      if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != reach) continue;
      const auto found = by_key_.find({cell.key.x + x, cell.key.y + y, cell.key.z + z, cell.key.solid});
      if (found == by_key_.end()) continue;
      const Cell& other = cells_[found->second];
      const std::uint32_t a = find_root(smallest_, sorted_[cell.begin]);
      const std::uint32_t b = find_root(smallest_, sorted_[other.begin]);
      if (a != b && within_gap(cell, other)) smallest_[std::max(a, b)] = std::min(a, b);
    }
  }

  bool within_gap(const Cell& a, const Cell& b) const {
    for (std::uint32_t i = a.begin; i < a.end; ++i) {
      const Float3 p = position(contacts_[sorted_[i]]);
      for (std::uint32_t j = b.begin; j < b.end; ++j) {
        if (shader::in_reach(p, position(contacts_[sorted_[j]]), limit_)) return true;
      }
    }
    return false;
  }

  const std::vector<Contact>& contacts_;
  float limit_;
  std::unordered_map<Key, std::uint32_t, KeyHash> by_key_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> sorted_;    ///< contacts cell by cell, ascending in each
  std::vector<std::uint32_t> smallest_;  ///< union-find over the cells' first contacts; at the end complete
};

/// Which clusters are fingers: those of enough contacts, of too many the largest, of equally large ones the first.
class Taken {
 public:
  Taken(const std::vector<std::uint32_t>& sizes, std::uint32_t least) : over_(least - 1) {
    std::vector<std::uint32_t> all;
    std::ranges::copy_if(sizes, std::back_inserter(all), [&](std::uint32_t size) { return size >= least; });
    clusters_ = static_cast<std::uint32_t>(all.size());
    if (clusters_ <= max_fingers) return;
    std::ranges::nth_element(all, all.begin() + max_fingers - 1, std::greater());
    over_ = all[max_fingers - 1];
    equal_ =
        max_fingers - static_cast<std::uint32_t>(std::ranges::count_if(all, [&](auto size) { return size > over_; }));
  }

  std::uint32_t clusters() const { return clusters_; }
  /// Asked in the order of the clusters.
  bool take(std::uint32_t size) {
    if (size != over_ || equal_ == 0) return size > over_;
    --equal_;
    return true;
  }

 private:
  std::uint32_t over_;       ///< larger ones are taken,
  std::uint32_t equal_ = 0;  ///< and so many of just that size
  std::uint32_t clusters_ = 0;
};

}  // namespace

void find_fingers(const Parameters& parameters, const PreparedSolids& solids, Touch& out) {
  std::vector<Contact> inside;  // contacts before deep points: a cluster's smallest point is a contact if it has any
  if (parameters.cluster == Cluster::inside) {
    inside = out.contacts;
    inside.insert(inside.end(), out.deep.begin(), out.deep.end());
  }
  const std::vector<Contact>& clustered = parameters.cluster == Cluster::inside ? inside : out.contacts;
  std::vector<std::uint32_t> smallest = Clustering(clustered, solids, float_gap(parameters)).smallest();
  smallest.resize(out.contacts.size());  // from here on contacts alone count

  std::vector<std::uint32_t> sizes(smallest.size());
  for (const std::uint32_t root : smallest)
    ++sizes[root];
  constexpr std::uint32_t none = shader::fingers_nothing;
  std::vector<std::uint32_t> finger_of_root(smallest.size(), none);
  out.finger_count = 0;
  Taken taken(sizes, std::max(parameters.min_points, 1U));
  out.cluster_count = taken.clusters();
  for (std::uint32_t i = 0; i < smallest.size(); ++i) {
    if (!taken.take(sizes[i])) continue;
    if (out.fingers.size() <= out.finger_count) out.fingers.emplace_back();
    finger_of_root[i] = out.finger_count;
    Finger& finger = out.fingers[out.finger_count++];
    finger.solid = out.contacts[i].solid;
    finger.contacts.clear();
  }
  for (std::uint32_t i = 0; i < smallest.size(); ++i) {
    if (finger_of_root[smallest[i]] != none) out.fingers[finger_of_root[smallest[i]]].contacts.push_back(i);
  }
  for (std::uint32_t f = 0; f < out.finger_count; ++f)
    out.fingers[f].contact_count = static_cast<std::uint32_t>(out.fingers[f].contacts.size());
}

}  // namespace palpa::touch
