#include "viewer/run/viewer_files.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>

#include "session/links/spec.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {

std::vector<Output> outputs_of(const ViewerOptions& options, const Script& script, const LiveSession::Kinds& kinds) {
  std::vector<Output> outputs{{"--json", options.common.json},
                              {"--screenshot", options.screenshot},
                              {"--video", options.video, Output::Kind::folder}};
  std::ranges::move(script.outputs(), std::back_inserter(outputs));
  if (options.is_live()) {
    setup::LiveOptions live = live_options(options.given);
    live.common.json.clear();  // --json is the viewer's own
    std::ranges::move(setup::outputs_of(live, setup::with_builtin(kinds.links)), std::back_inserter(outputs));
  }
  return outputs;
}

void refuse_outputs_as_inputs(const ViewerOptions& options) {
  std::vector<std::string> files{options.input.scene, options.input.points, options.input.rig, options.skin,
                                 options.screen,      options.reference,    options.interact};
  std::ranges::copy(options.input.depths, std::back_inserter(files));
  std::ranges::copy(options.input.cameras, std::back_inserter(files));
  files.push_back(options.sensation);
  if (options.is_live()) files.push_back(session::parse_spec(options.live.source).argument);
  // Built-in layouts are names, not files.
  if (std::filesystem::path(options.layout).has_extension()) files.push_back(options.layout);
  for (const std::string& file : files)
    refuse_output_as_input(file);
}

}  // namespace palpa::viewer
