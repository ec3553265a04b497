// The driver's rows of `palpa bench`.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/row.hpp"

namespace palpa::driver {

/// Measures sixteen OpenMPD boards, one drive after the other: the time for encoding, and the time from the drive to
/// the last byte that the transport has taken. The bus is in this process, and its devices accept everything. At least
/// 1000 drives, for a 99th percentile.
void measure_links(std::uint32_t runs, std::vector<bench::Row>& rows);

}  // namespace palpa::driver
