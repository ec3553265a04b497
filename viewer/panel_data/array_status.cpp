#include "viewer/panel_data/array_status.hpp"

namespace palpa::viewer {
namespace {

std::string why_off(const PanelData& data) {
  if (data.empty) return "nothing is open";
  if (!data.live) return "one touch, nothing is sent";
  switch (data.live_state) {
    case LiveState::loading:
      return "the run is loading";
    case LiveState::failed:
      return "the run has failed" + (data.fault.empty() ? "" : ": " + data.fault);
    case LiveState::ended:
    case LiveState::running:
      break;
  }
  return "Start begins a run";
}

}  // namespace

ArrayStatus array_status(const PanelData& data) {
  if (!data.live || data.live_state != LiveState::running) return {ArrayState::off, "OFF", why_off(data)};
  const std::string& link = data.edit.options().link;
  const bool none = link == "null";
  if (data.stuck) return {ArrayState::silent, "SILENT", link + " takes no drives"};
  if (!data.sounding) return {ArrayState::silent, "SILENT", none ? "no array" : link};
  return {ArrayState::sounding, "SOUNDING", none ? "no array" : "on " + link};
}

}  // namespace palpa::viewer
