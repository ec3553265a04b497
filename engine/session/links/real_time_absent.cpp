#include "session/links/real_time_service.hpp"

namespace palpa::session {

RealTimeService real_time_service() {
  return nullptr;
}

}  // namespace palpa::session
