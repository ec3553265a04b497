// The results that the test matrix compares between its legs.
#pragma once

#include <cstdint>
#include <string>

namespace palpa::test {

/// Prints the hash of a result. With PALPA_DIGESTS=FOLDER, also writes it to the file `name` there:
/// tests/house/matrix.sh checks that it is the same for any number of threads, vector width and memory.
void tell_digest(const std::string& name, std::uint64_t hash);

}  // namespace palpa::test
