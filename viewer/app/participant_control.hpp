// The participant's window: whether it is open, on which monitor, and what it says.
#pragma once

#include <string>
#include <vector>

#include "viewer/app/staleness.hpp"
#include "viewer/options/viewer_options.hpp"
#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

class ParticipantControl {
 public:
  /// Writes to the others, which must outlive it.
  ParticipantControl(PanelData::ParticipantWindowState& window, Messages& messages, Staleness& stale)
      : window_(&window), messages_(&messages), stale_(&stale) {}

  /// Opens the window for the rig's screen, which is read only now, because a rig may have none. Throws as
  /// participant_of() does.
  void open(const ViewerOptions& options, double now_s);
  void close() { window_->open = false; }
  /// Its content could not be drawn, or it could not be opened.
  void failed(const std::string& fault);
  /// The monitors that there are. Throws bad_usage if `wanted`, which is --monitor, is not one of them.
  void tell_monitors(std::vector<std::string> names, const std::string& wanted);
  /// On a single monitor, the window covers the other, so it says for a while how to leave it.
  void advance(double now_s);
  /// Until then, it says so.
  double leave_line_until_s() const { return leave_line_until_s_; }
  /// Warns once if the window's shape is not that of the rig's screen.
  void fills(const Size& size);

 private:
  PanelData::ParticipantWindowState* window_;
  Messages* messages_;
  Staleness* stale_;
  double leave_line_until_s_ = 0;
  std::string stretched_;  ///< the warning about the window's shape that was given
};

}  // namespace palpa::viewer
