// A host's requests to a UVC device's controls (UVC 1.5, table A-8).
#pragma once

#include <cstdint>

namespace palpa::test {

enum UvcRequest : std::uint8_t {
  set_cur = 0x01,
  get_cur = 0x81,
  get_min,
  get_max,
  get_res,
  get_len,
  get_info,
  get_def
};

}  // namespace palpa::test
