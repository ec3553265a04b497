#include "viewer/desk/array_status.hpp"

namespace palpa::viewer {
namespace {

std::string why_off(const Desk& desk) {
  if (desk.empty) return "nothing is open";
  if (!desk.live) return "one touch, nothing is sent";
  switch (desk.live_state) {
    case LiveState::loading:
      return "the run is loading";
    case LiveState::failed:
      return "the run has failed" + (desk.fault.empty() ? "" : ": " + desk.fault);
    case LiveState::ended:
    case LiveState::running:
      break;
  }
  return "Start begins a run";
}

}  // namespace

ArrayStatus array_status(const Desk& desk) {
  if (!desk.live || desk.live_state != LiveState::running) return {ArrayState::off, "OFF", why_off(desk)};
  const std::string& link = desk.edit.options().link;
  const bool none = link == "null";
  if (desk.stuck) return {ArrayState::silent, "SILENT", link + " takes no drives"};
  if (!desk.sounding) return {ArrayState::silent, "SILENT", none ? "no array" : link};
  return {ArrayState::sounding, "SOUNDING", none ? "no array" : "on " + link};
}

}  // namespace palpa::viewer
