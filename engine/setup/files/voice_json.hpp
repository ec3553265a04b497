// Members of JSON objects that say how a finger sounds, as in a touch (touch_file.hpp) and in a file of foci
// (played_foci.hpp). All functions throw bad_input, naming the file and the object.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf_document/json.hpp"

namespace palpa::setup {

inline constexpr double shortest_dwell_s = 1e-6, longest_dwell_s = 10;

/// A member that is a number within [low, high].
double number(const geometry::gltf::Item& item, const char* key, double low, double high);

/// A place of `item`'s "foci_m": three numbers in metres, in single precision as palpa writes them. `or_null` ends the
/// message if null is another valid value.
Vec3 read_place(const geometry::gltf::Item& item, const geometry::gltf::Json& value, bool or_null);

/// The list of `item`'s "foci_m", with at least one and at most touch::max_foci values.
const geometry::gltf::Json& list_of_foci(const geometry::gltf::Item& item);

/// The member "order": numbers of foci below touch::max_foci, at least one. Those that sound together are a list, and
/// all lists are equally long.
struct Order {
  std::vector<std::uint32_t> foci;
  std::uint32_t foci_per_slot = 1;
  bool lists = false;  ///< whether the foci that sound together are lists, even if these have one focus each
};
Order read_order(const geometry::gltf::Item& item);

}  // namespace palpa::setup
