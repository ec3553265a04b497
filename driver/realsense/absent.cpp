#include "base/error.hpp"
#include "driver/realsense/sdk.hpp"

namespace palpa::driver::realsense {

std::unique_ptr<Sdk> make_sdk() {
  throw bad_usage(
      "source realsense: this palpa was built without librealsense2; use v4l2:/dev/videoN, which needs no SDK, or "
      "install librealsense2 2.55 or later and build palpa again with -DPALPA_REALSENSE=ON");
}

}  // namespace palpa::driver::realsense
