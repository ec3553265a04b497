// Contacts are sorted by cell, and cells are joined pair by pair. Existing cells are looked up tile by tile.
#include "touch/points/clusters_twin.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <numeric>
#include <utility>

#include "shaders/touch/clusters/clusters_math.h"
#include "touch/points/cluster_cells.hpp"

namespace palpa::touch {
namespace {

using shader::Float3;

using Key = ClusterWork::Key;
using Tile = ClusterWork::Tile;
using Cell = ClusterWork::Cell;

std::size_t hash_of(const Key& k) {
  std::uint64_t h = static_cast<std::uint32_t>(k.x) * 0x9e3779b97f4a7c15ULL;
  h = (h ^ static_cast<std::uint32_t>(k.y)) * 0xc2b2ae3d27d4eb4fULL;
  h = (h ^ static_cast<std::uint32_t>(k.z)) * 0x165667b19e3779f9ULL;
  h = (h ^ k.solid) * 0x9e3779b97f4a7c15ULL;
  return h ^ h >> 32;
}

constexpr int tile_side = 4;
constexpr std::size_t tile_cells = 64;
/// The number of tiles that touch a tile, including the tile itself, which is `centre`. One tile of each opposite pair
/// comes after it.
constexpr std::size_t tiles_around = 27, centre = 13;

/// For each surrounding tile, each cell of the tile, and each distance (in cells, along the widest direction, minus
/// one): the cells in the surrounding tile.
using Reach = std::array<std::array<std::array<std::uint64_t, 2>, tile_cells>, tiles_around>;

constexpr Reach make_reach() {
  Reach reach{};
  for (std::size_t cell = 0; cell < tile_cells; ++cell) {
    const int from = static_cast<int>(cell);
    for (int place = 0; place < 125; ++place) {
      const int dx = place % 5 - 2, dy = place / 5 % 5 - 2, dz = place / 25 - 2;
      const int distance = std::max({dx < 0 ? -dx : dx, dy < 0 ? -dy : dy, dz < 0 ? -dz : dz});
      if (distance == 0) continue;
      // Counted from the preceding tile, so that nothing is negative.
      const int x = from % 4 + dx + tile_side, y = from / 4 % 4 + dy + tile_side, z = from / 16 + dz + tile_side;
      const int tile = x / tile_side + 3 * (y / tile_side) + 9 * (z / tile_side);
      const int there = x % tile_side + 4 * (y % tile_side) + 16 * (z % tile_side);
      reach[static_cast<std::size_t>(tile)][cell][static_cast<std::size_t>(distance - 1)] |= std::uint64_t{1} << there;
    }
  }
  return reach;
}

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

/// The contact's tile, and its cell there.
std::pair<Key, std::size_t> cell_of(const Contact& contact, const PreparedSolids& solids, float density) {
  const shader::vec4& middle = solids.records[contact.solid].centre;
  const auto along = [&](float p, float c) { return static_cast<std::int32_t>(std::floor((p - c) * density)); };
  const std::int32_t x = along(contact.position.x, middle.x), y = along(contact.position.y, middle.y),
                     z = along(contact.position.z, middle.z);
  return {{x >> 2, y >> 2, z >> 2, contact.solid}, static_cast<std::size_t>((x & 3) + 4 * (y & 3) + 16 * (z & 3))};
}

std::uint64_t bit(std::size_t cell) {
  return std::uint64_t{1} << cell;
}

std::uint32_t number_of(const Tile& tile, std::size_t cell) {
  return tile.first_cell + static_cast<std::uint32_t>(std::popcount(tile.cells & (bit(cell) - 1)));
}

constexpr std::uint32_t none = shader::clusters_nothing;

std::size_t table_size(std::size_t contacts) {
  return std::bit_ceil(2 * contacts);
}

/// Finds each contact's cluster: its smallest contact, in `work.smallest`.
class Clustering {
 public:
  Clustering(const std::vector<Contact>& contacts, float gap, ClusterWork& work)
      : contacts_(contacts), gap_(gap), limit_(gap * gap), work_(work) {}

  void find(const PreparedSolids& solids) {
    sort_into_cells(solids, cells_per_metre(gap_));
    work_.smallest.resize(contacts_.size());
    std::iota(work_.smallest.begin(), work_.smallest.end(), 0U);
    // Touching cells come first: most other pairs are then already in one cluster.
    for (const std::size_t distance : {0U, 1U}) {
      for (const Tile& tile : work_.tiles)
        link(tile, distance);
    }
    for (const Cell& cell : work_.cells) {
      const std::uint32_t root = find_root(work_.smallest, work_.sorted[cell.begin]);
      for (std::uint32_t k = cell.begin; k < cell.end; ++k)
        work_.smallest[work_.sorted[k]] = root;
    }
  }

 private:
  /// The entry of the table that has the tile's number, or else the empty one where it would be.
  std::uint32_t& entry_of(const Key& key) {
    const std::size_t mask = work_.table.size() - 1;
    std::size_t at = hash_of(key) & mask;
    while (work_.table[at] != none && work_.tiles[work_.table[at]].key != key)
      at = (at + 1) & mask;
    return work_.table[at];
  }

  std::uint32_t tile_of(const Key& key) {
    std::uint32_t& entry = entry_of(key);
    if (entry == none) {
      entry = static_cast<std::uint32_t>(work_.tiles.size());
      work_.tiles.push_back({key});
    }
    return entry;
  }

  void sort_into_cells(const PreparedSolids& solids, float density) {
    std::vector<Tile>& tiles = work_.tiles;
    std::vector<Cell>& cells = work_.cells;
    std::vector<ClusterWork::Place>& places = work_.places;
    work_.table.assign(table_size(contacts_.size()), none);
    tiles.clear();
    places.clear();
    for (const Contact& contact : contacts_) {
      const auto [key, cell] = cell_of(contact, solids, density);
      const bool same = !places.empty() && tiles[places.back().tile].key == key;
      const std::uint32_t tile = same ? places.back().tile : tile_of(key);
      places.push_back({tile, static_cast<std::uint32_t>(cell)});
      tiles[tile].cells |= bit(cell);
    }
    std::uint32_t count = 0;
    for (Tile& tile : tiles) {
      tile.first_cell = count;
      count += static_cast<std::uint32_t>(std::popcount(tile.cells));
    }
    cells.assign(count, {});
    for (ClusterWork::Place& place : places) {
      place.cell = number_of(tiles[place.tile], place.cell);
      ++cells[place.cell].end;
    }
    std::uint32_t sum = 0;
    for (Cell& cell : cells) {
      cell.begin = sum;
      sum += cell.end;
      cell.end = cell.begin;
    }
    work_.sorted.resize(contacts_.size());
    for (std::uint32_t i = 0; i < contacts_.size(); ++i)
      work_.sorted[cells[places[i].cell].end++] = i;
  }

  /// Unites the tile's cells with those `distance` + 1 cells away in the widest direction, each pair once.
  void link(const Tile& tile, std::size_t distance) {
    static constexpr Reach reach = make_reach();
    for (std::size_t around = centre; around < tiles_around; ++around) {
      const Tile* other = around == centre ? &tile : nullptr;
      for (std::uint64_t left = tile.cells; left != 0; left &= left - 1) {
        const auto cell = static_cast<std::size_t>(std::countr_zero(left));
        std::uint64_t there = reach[around][cell][distance];
        if (there == 0) continue;
        if (other == nullptr) {
          const int n = static_cast<int>(around);
          const std::uint32_t found =
              entry_of({tile.key.x + n % 3 - 1, tile.key.y + n / 3 % 3 - 1, tile.key.z + n / 9 - 1, tile.key.solid});
          if (found == none) break;
          other = &work_.tiles[found];
        }
        there &= other->cells;
        if (around == centre) there &= ~(bit(cell) - 1);
        for (; there != 0; there &= there - 1)
          unite(work_.cells[number_of(tile, cell)],
                work_.cells[number_of(*other, static_cast<std::size_t>(std::countr_zero(there)))]);
      }
    }
  }

  void unite(const Cell& one, const Cell& other) {
    const std::uint32_t a = find_root(work_.smallest, work_.sorted[one.begin]);
    const std::uint32_t b = find_root(work_.smallest, work_.sorted[other.begin]);
    if (a != b && within_gap(one, other)) work_.smallest[std::max(a, b)] = std::min(a, b);
  }

  bool within_gap(const Cell& a, const Cell& b) const {
    for (std::uint32_t i = a.begin; i < a.end; ++i) {
      const Float3 p = position(contacts_[work_.sorted[i]]);
      for (std::uint32_t j = b.begin; j < b.end; ++j) {
        if (shader::in_reach(p, position(contacts_[work_.sorted[j]]), limit_)) return true;
      }
    }
    return false;
  }

  const std::vector<Contact>& contacts_;
  float gap_, limit_;
  ClusterWork& work_;
};

/// Decides which clusters may be fingers: those with enough contacts. If there are too many, the largest are taken, and
/// among equally large ones the first.
class Taken {
 public:
  /// `all` is scratch.
  Taken(const std::vector<std::uint32_t>& sizes, std::uint32_t least, std::vector<std::uint32_t>& all)
      : over_(least - 1) {
    all.clear();
    std::ranges::copy_if(sizes, std::back_inserter(all), [&](std::uint32_t size) { return size >= least; });
    clusters_ = static_cast<std::uint32_t>(all.size());
    if (clusters_ <= max_fingers) return;
    std::ranges::nth_element(all, all.begin() + max_fingers - 1, std::greater());
    over_ = all[max_fingers - 1];
    equal_ =
        max_fingers - static_cast<std::uint32_t>(std::ranges::count_if(all, [&](auto size) { return size > over_; }));
  }

  std::uint32_t clusters() const { return clusters_; }
  /// Must be called in the order of the clusters.
  bool take(std::uint32_t size) {
    if (size != over_ || equal_ == 0) return size > over_;
    --equal_;
    return true;
  }

 private:
  std::uint32_t over_;       ///< larger clusters are taken,
  std::uint32_t equal_ = 0;  ///< and this many of exactly that size
  std::uint32_t clusters_ = 0;
};

}  // namespace

void reserve(ClusterWork& work, std::size_t points) {
  work.inside.reserve(points);
  work.table.reserve(table_size(points));
  work.tiles.reserve(points);
  work.cells.reserve(points);
  work.places.reserve(points);
  for (std::vector<std::uint32_t>* values :
       {&work.sorted, &work.smallest, &work.sizes, &work.large, &work.finger_of_root})
    values->reserve(points);
}

void find_clusters(const FingerOptions& parameters, const PreparedSolids& solids, ClusterWork& work, Touch& out) {
  const bool with_deep = parameters.cluster == Cluster::inside;
  if (with_deep) {  // contacts before deep points, so a cluster's smallest point is a contact if it has any
    work.inside.assign(out.contacts.begin(), out.contacts.end());
    work.inside.insert(work.inside.end(), out.deep.begin(), out.deep.end());
  }
  Clustering(with_deep ? work.inside : out.contacts, float_gap(parameters), work).find(solids);
  work.smallest.resize(out.contacts.size());  // from here on, only contacts count

  const std::vector<std::uint32_t>& smallest = work.smallest;
  work.sizes.assign(smallest.size(), 0);
  for (const std::uint32_t root : smallest)
    ++work.sizes[root];
  work.finger_of_root.assign(smallest.size(), none);
  out.finger_count = 0;
  Taken taken(work.sizes, std::max(parameters.min_points, 1U), work.large);
  out.cluster_count = taken.clusters();
  for (std::uint32_t i = 0; i < smallest.size(); ++i) {
    if (!taken.take(work.sizes[i])) continue;
    if (out.fingers.size() <= out.finger_count) out.fingers.emplace_back();
    work.finger_of_root[i] = out.finger_count;
    Finger& finger = out.fingers[out.finger_count++];
    finger.solid = out.contacts[i].solid;
    finger.contacts.clear();
  }
  for (std::uint32_t i = 0; i < smallest.size(); ++i) {
    const std::uint32_t finger = work.finger_of_root[smallest[i]];
    if (finger != none) out.fingers[finger].contacts.push_back(i);
  }
  for (std::uint32_t f = 0; f < out.finger_count; ++f)
    out.fingers[f].contact_count = static_cast<std::uint32_t>(out.fingers[f].contacts.size());
}

}  // namespace palpa::touch
