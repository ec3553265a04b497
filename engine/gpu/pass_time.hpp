// The time of a pass, measured on a device or on the host.
#pragma once

namespace palpa::gpu {

struct PassTime {
  const char* name;  ///< a string literal
  double ms;
};

}  // namespace palpa::gpu
