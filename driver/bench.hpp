// The driver's rows of `palpa bench`.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/row.hpp"

namespace palpa::driver {

/// Sixteen OpenMPD boards, one drive after the other: encoding them, and from the drive to the last byte that the
/// transport has taken, on a bus of this process whose devices swallow all. At least 1000 drives, for a 99th
/// percentile.
void measure_links(std::uint32_t runs, std::vector<bench::Row>& rows);

}  // namespace palpa::driver
