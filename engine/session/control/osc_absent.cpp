#include <string>

#include "base/error.hpp"
#include "session/control/osc_message.hpp"

namespace palpa::session {

void check_osc() {
  throw bad_usage(std::string("--osc: this palpa was built without liblo; ") + how_to_get_liblo);
}

std::optional<OscMessage> read_osc_message(std::span<char>) {
  return std::nullopt;
}

}  // namespace palpa::session
