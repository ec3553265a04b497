// The window of `palpa-viewer --by-touch`: guides a person from focus to focus, takes the keys, and ends the run in
// silence before the poses are computed.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "setup/tasks/by_touch.hpp"
#include "setup/tasks/nudge.hpp"
#include "viewer/app/shown_run.hpp"
#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

class TouchGuide {
 public:
  /// `json`: a file for the result, or empty.
  TouchGuide(setup::ByTouch& task, std::string json);

  /// Whether the event is the guide's. ALL OFF, the key O and the keys of the view are not.
  bool takes(const WindowEvent& event, const ShownRun& run);
  /// What to say now. When the keys have ended, silences the run and writes the result. Returns whether the window may
  /// close.
  bool advance(ShownRun& run, PanelData& data);
  /// The foci, over the picture.
  void mark(const Sight& sight, std::vector<FlatMark>& marks) const;

  /// After the window: the summary. Throws what kept the result from being written, and failure if a script ended
  /// before the keys did.
  std::string end(bool scripted);

 private:
  enum class Step { touches, found, failed, left };
  Guidance guidance(const ShownRun& run, const PanelData& data) const;
  void finish();

  setup::ByTouch* task_;
  std::string json_;
  setup::Nudge nudge_;
  Step step_ = Step::touches;
  bool begun_ = false;   ///< the run has had a frame
  bool closes_ = false;  ///< somebody has read the result
  std::string summary_;
  std::exception_ptr fault_;
  std::string fault_line_;
};

}  // namespace palpa::viewer
