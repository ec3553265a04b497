// Clusters in plain C++: exact Euclidean clusters of each solid's contacts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Scratch that keeps its storage.
struct ClusterWork {
  /// The place of a tile among those of its solid.
  struct Key {
    std::int32_t x, y, z;
    std::uint32_t solid;
    bool operator==(const Key&) const = default;
  };
  /// 4x4x4 cells; `key` counts tiles.
  struct Tile {
    Key key;
    std::uint64_t cells = 0;       ///< the cells that hold contacts, as bits
    std::uint32_t first_cell = 0;  ///< the cells are numbered consecutively in the order of the bits
  };
  struct Cell {
    std::uint32_t begin, end;  ///< in `sorted`
  };
  /// The cell of a contact, first as a bit of its tile, later as its number.
  struct Place {
    std::uint32_t tile, cell;
  };
  std::vector<Contact> inside;       ///< with Cluster::inside: what is clustered
  std::vector<std::uint32_t> table;  ///< hash table of the tiles' numbers; at least half of it is empty
  std::vector<Tile> tiles;
  std::vector<Cell> cells;
  std::vector<Place> places;
  std::vector<std::uint32_t> sorted;    ///< contacts cell by cell, ascending in each
  std::vector<std::uint32_t> smallest;  ///< union-find over the cells' first contacts; at the end complete
  std::vector<std::uint32_t> sizes, large, finger_of_root;
};

/// Reserves all that find_clusters needs for this many contacts and deep points.
void reserve(ClusterWork& work, std::size_t points);

/// C++ twin of ClustersPass: fills `out.fingers` (solid and contacts), `finger_count` and `cluster_count` from
/// `out.contacts`, and with Cluster::inside also from `out.deep`. The distance test uses the same single-precision
/// arithmetic, so the partition is the same. The parameters must pass check_parameters().
void find_clusters(const FingerOptions& parameters, const PreparedSolids& solids, ClusterWork& work, Touch& out);

}  // namespace palpa::touch
