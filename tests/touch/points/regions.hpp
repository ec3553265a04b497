// Euclidean clusters by region growing over nanoflann's k-d tree: a different structure, a different traversal, and
// code of other people.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "touch/types.hpp"

namespace palpa::touch::test {

using Regions = std::vector<std::vector<std::uint32_t>>;  ///< each ascending, ordered by their first

/// Contacts of one solid that steps of at most the gap connect.
Regions grow_regions(const std::vector<Contact>& contacts, double gap_m);

/// How the fingers of a touch differ from the regions of its contacts, or of all skin inside if that is clustered;
/// empty if they do not. If there are more than max_fingers, the largest are compared.
std::string not_regions(const Touch& touch, const FingerOptions& parameters);

}  // namespace palpa::touch::test
