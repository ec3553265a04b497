// The `extras` of a node that palpa reads.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/gltf_document/json.hpp"
#include "geometry/haptics.hpp"

namespace palpa::geometry::gltf {

/// The values of one node itself. `touchable` is optional here so that a child can inherit it.
struct NodeHaptics {
  std::optional<bool> touchable;
  Haptics values;
  /// Written by palpa decompose: the node's mesh is a convex part of the solid of this name. Neither this nor seam_m is
  /// inherited.
  std::optional<std::string> part_of;
  std::optional<double> seam_m;  ///< 0 to 1 m, see Parts::seam_m
};

/// Keys that begin with "palpa" in any spelling but have no meaning, each with the name of the first node that has it.
using UnknownKeys = std::map<std::string, std::string>;

/// Reads {"palpa": {"delta_m": 0.0015, ...}} and the flat form {"palpa_delta_m": 0.0015, ...} of the node's `extras`;
/// other keys are ignored. Throws bad_input naming the node and the key: a wrong type, a number out of range, a key
/// given in both forms. `touchable` may be 0 or 1, because some modelling programs have no booleans.
NodeHaptics read_extras(const Item& node, UnknownKeys& unknown);

/// A child's haptics: each value is the child's own, else its parent's (which may be inherited itself). `parent` is
/// Haptics{} for a root. Throws bad_input naming the node if foci and stride then have a common divisor, or if there is
/// a click without a press depth.
Haptics inherit(const Item& node, const NodeHaptics& own, const Haptics& parent);

/// Whether an object has keys that read_extras() would read or warn about.
bool has_palpa_extras(const Item& item);

/// For the warning of keys elsewhere.
inline constexpr const char* extras_belong_to_nodes =
    "palpa reads only the extras of nodes (Blender: the object's custom properties)";

/// The places, at most 8, where extras beside those of nodes and meshes have such keys: "material 0", "asset",
/// "extensions, KHR_lights_punctual, light 0". They have no meaning there.
std::vector<std::string> extras_elsewhere(const Item& root);

/// For "palpa_delta" or "palpaDelta": the key that was probably meant, for the warning; all known keys if none is
/// similar.
std::string explain_unknown(const std::string& key);

}  // namespace palpa::geometry::gltf
