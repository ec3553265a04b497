// SHA-256 (FIPS 180-4), for a prediction's fingerprint: two texts with the same hash cannot be made on purpose.
#pragma once

#include <string>
#include <string_view>

namespace palpa::study {

/// 64 hexadecimal digits, as sha256sum prints them.
std::string sha256(std::string_view text);

}  // namespace palpa::study
