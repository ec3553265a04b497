#include "sensing/joints/tracker.hpp"

#include "base/error.hpp"

namespace palpa::sensing {
namespace {

constexpr const char* live = "udp:";

}  // namespace

bool is_live_tracker(const std::string& argument) {
  return argument.starts_with(live);
}

std::unique_ptr<Tracker> open_tracker(const std::string& argument, bool paced) {
  if (argument.empty()) throw bad_usage("source joints needs a port or a file: joints:udp:9000 or joints:FILE");
  if (is_live_tracker(argument)) return open_udp_tracker(argument.substr(std::string(live).size()));
  return open_file_tracker(argument, paced);
}

}  // namespace palpa::sensing
