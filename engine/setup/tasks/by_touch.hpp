// `palpa calibrate --by-touch`, on a terminal and in the viewer's window: from options to the live run that plays the
// foci, and from its touches to the new rig.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sensing/rig.hpp"
#include "session/links/link.hpp"
#include "session/links/sources.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/register_cameras.hpp"

namespace palpa::setup {

class ByTouch {
 public:
  /// Makes `options` those of the run. They name the cameras as its source, and `kinds` and `links` are added to
  /// palpa's own. `out` is the rig to write. Throws bad_usage for a source that is no camera, and for --noise-free with
  /// a real one; and as load_posed_rig does.
  ByTouch(LiveOptions& options, std::string out, std::span<const session::SourceKind> kinds,
          std::span<const session::LinkKind> links);
  ByTouch(const ByTouch&) = delete;
  ByTouch& operator=(const ByTouch&) = delete;

  CameraTouches& touches() { return touches_; }
  const CameraTouches& touches() const { return touches_; }
  const array::Layout& layout() const { return posed_.layout; }
  /// The sources of the run.
  const std::vector<session::SourceKind>& sources() const { return sources_; }

  /// Writes the rig if it `saves`, which needs all touches, and the result as JSON if `json` names a file. Returns the
  /// summary. Throws as register_camera() does.
  std::string finish(bool saves, const std::string& json) const;

 private:
  RigOptions rig_;
  std::string out_;
  PosedRig posed_;
  CameraTouches touches_;
  std::vector<session::SourceKind> sources_;
};

}  // namespace palpa::setup
