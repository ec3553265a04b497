// What palpa reads from a node's `extras`.
#pragma once

#include <map>
#include <string>

#include "geometry/gltf_document/json.hpp"
#include "geometry/haptics.hpp"

namespace palpa::geometry::gltf {

/// What one node says itself; `touchable` is optional here so that a child can take it over.
struct NodeHaptics {
  std::optional<bool> touchable;
  Haptics values;
  /// What palpa decompose writes: the node's mesh is a convex part of the solid of this name; neither is inherited.
  std::optional<std::string> part_of;
  std::optional<double> seam_m;  ///< 0 to 1 m, see Parts::seam_m
};

/// Keys beginning with "palpa" that mean nothing, each with the name of the first node that has it.
using UnknownKeys = std::map<std::string, std::string>;

/// Reads {"palpa": {"delta_m": 0.0015, ...}} and the flat form {"palpa_delta_m": 0.0015, ...} of the node's `extras`;
/// all else in there is somebody else's. Throws bad_input naming the node and the key: a wrong type, a number out of
/// range, one key given in both forms. `touchable` may be 0 or 1, for want of
/// booleans in some modelling programs.
NodeHaptics read_extras(const Item& node, UnknownKeys& unknown);

/// A child's haptics: each value is the child's own, else what its parent has (which may be inherited itself).
/// `parent` is Haptics{} for a root. Throws bad_input naming the node where foci and stride then have a common divisor.
Haptics inherit(const Item& node, const NodeHaptics& own, const Haptics& parent);

/// Whether an object carries what read_extras() would read or remark on.
bool has_palpa_extras(const Item& item);

/// "palpa_delta": what it might have been meant to be, for the warning; all known keys if nothing is near.
std::string explain_unknown(const std::string& key);

}  // namespace palpa::geometry::gltf
