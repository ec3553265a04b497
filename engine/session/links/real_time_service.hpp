// rtkit, the service through which programs of a desktop, such as its sound, get real-time scheduling without a user's
// permission for it.
#pragma once

#include "base/system/real_time.hpp"

namespace palpa::session {

/// Asks rtkit on the system's D-Bus. Without rtkit, without D-Bus, or in a palpa that was built without D-Bus, nothing
/// changes.
RealTimeService real_time_service();

/// One line: how this user gets real-time scheduling.
inline const char* how_to_get_real_time() {
  if (!has_time_for_real_time(0)) return "give this process an RLIMIT_RTTIME of at least 50 ms (prlimit --rttime)";
  return "apt-get install rtkit, or as root: echo '@audio - rtprio 20' > /etc/security/limits.d/palpa.conf, add "
         "yourself to the group audio, and log in again";
}

}  // namespace palpa::session
