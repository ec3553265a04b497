#include "viewer/panel_data/array_status.hpp"

#include "session/links/board_sound.hpp"

namespace palpa::viewer {
namespace {

std::string why_off(const Content& content) {
  if (content.empty) return "nothing is open";
  if (!content.live) return content.edit.options().scene.empty() ? "nothing is sent" : "one touch, nothing is sent";
  switch (content.run.state) {
    case LiveState::loading:
      return "the run is loading";
    case LiveState::failed:
      return "the run has failed" + (content.run.fault.empty() ? "" : ": " + content.run.fault);
    case LiveState::ended:
    case LiveState::running:
      break;
  }
  return "Start begins a run";
}

}  // namespace

ArrayStatus array_status(const Content& content) {
  if (!content.live || content.run.state != LiveState::running) {
    const std::string boards = session::boards_that_may_sound();
    if (!boards.empty()) return {ArrayState::unknown, "MAY SOUND", boards};
    return {ArrayState::off, "OFF", why_off(content)};
  }
  const std::string& link = content.edit.options().link;
  const bool none = link == "null";
  if (content.run.stuck) return {ArrayState::unknown, "MAY SOUND", link + " takes no drives"};
  if (!content.run.sounding) return {ArrayState::silent, "SILENT", none ? "no array" : link};
  return {ArrayState::sounding, "SOUNDING", none ? "no array" : "on " + link};
}

}  // namespace palpa::viewer
