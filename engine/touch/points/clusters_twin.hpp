// Clusters in plain C++: exact Euclidean clusters of each solid's contacts.
#pragma once

#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of ClustersPass: fills `out.fingers` (solid and contacts), `finger_count` and `cluster_count` from
/// `out.contacts`, and with Cluster::inside also from `out.deep`. The distance test uses the same single-precision
/// arithmetic, so the partition is the same. The parameters must pass check_parameters().
void find_clusters(const Parameters& parameters, const PreparedSolids& solids, Touch& out);

}  // namespace palpa::touch
