#include "viewer/run/touch_line.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "line/help.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/tasks/by_touch.hpp"
#include "viewer/app/touch_guide.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/run/command.hpp"

namespace palpa::viewer {
namespace {

line::HelpText touch_help() {
  return {.name = "palpa-viewer --by-touch",
          .arguments = "",
          .summary = "where the cameras are, by eight foci that you touch, as palpa calibrate --by-touch in a window",
          .usual = "--by-touch --rig --source --link --out --layout --hold --ceiling --size --json",
          .examples =
              "  palpa-viewer --by-touch --rig my-rig.toml --source v4l2:/dev/video0 --link openmpd:FT43NK5M \\\n"
              "               --out touched.toml\n"
              "  palpa-viewer --by-touch --rig assets/rigs/openmpd-one.toml --out touched.toml      a rehearsal\n",
          .notes =
              "The window says what to do. docs/calibration.md has all steps. Exit codes: 0 done, 1 failed, 2 wrong "
              "usage, 3 no display, 4 bad or missing input."};
}

void add_touch_options(CLI::App& app, ViewerOptions& o, setup::LiveOptions& live, std::string& out) {
  static bool by_touch = false;
  const line::Group what(app, "By touch");
  what.flag("--by-touch", by_touch, "plays eight foci, which you touch, and finds the cameras' poses");
  what.text("--out", out, "FILE", "writes the rig with the poses that were found; must differ from --rig");
  what.text("--source", live.source, "SOURCE",
            "cameras: synthetic (a rehearsal with a simulated finger), v4l2:/dev/videoN[,...], "
            "realsense:SERIAL[,...], bag:FILE or recording:DIR [synthetic]");
  what.flag("--noise-free", live.noise_free, "renders synthetic frames without the sensor's noise");
  setup::add_link(what, live);
  what.quantity("--hold", live.hold_s, Quantity::time, line::positive(10),
                "how long the newest frame sounds if no other comes");
  setup::add_safety(what, live.safety);
  setup::add_rig_options(app, live.rig);
  setup::add_medium_options(app, live.drive.medium);
  const line::Group window(app, "The window");
  window.text("--size", o.size, "WxH", "size of the picture or window in pixels");
  window.flag("--dark", o.dark, "draws on a dark background");
  window.text("--interact", o.interact, "FILE", "does what a script says (docs/viewer.md) [no script]");
  window.flag("--headless", o.headless, "opens no window");
  window.text("--screenshot", o.screenshot, "FILE", "writes the last frame as PNG [no file]");
  line::need(app, {"--headless"}, "--interact");
  line::need(app, {"--screenshot"}, "--headless");
}

/// Where the run has its focus is marked over the picture, and what touches is only where palpa wants a finger.
constexpr const char* no_object = "solids,edges,skin,points,contacts,foci,legend,grid";

}  // namespace

bool asks_for_touches(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--by-touch") return true;
  }
  return false;
}

std::optional<TouchLine> read_touch_line(int argc, const char* const* argv) {
  CLI::App app("", "palpa-viewer");
  TouchLine line;
  setup::LiveOptions live;
  add_touch_options(app, line.options, live, line.out);
  setup::add_common(app, line.options.common);
  const auto help = [&] { return line::help_page(app, touch_help(), line::help_length(argc, argv)); };
  if (!parse_line(app, line.options.common, argc, argv, help)) return std::nullopt;
  if (line.out.empty()) throw bad_usage("--by-touch: --out is missing: give a file for the new rig");
  line::Given given = line::given_on(app);
  for (const char* own : {"--by-touch", "--out", "--json"})
    given.erase(own);
  line.json = line.options.common.json;
  line.options = options_of(given);
  return line;
}

void run_by_touch(TouchLine line, LiveSession::Kinds kinds,
                  void (*show)(const ViewerOptions&, const LiveSession::Kinds&, TouchGuide*)) {
  line::Given given = line.options.given;
  setup::LiveOptions live = values_of(given);
  setup::ByTouch task(live, line.out, kinds.sources, kinds.links);
  given.erase("--noise-free");
  given["--scene"] = {live.scene};
  given["--source"] = {live.source};
  given["--method"] = {"single-focus"};
  given["--hide"] = {no_object};
  if (!live.rig.layout.empty()) given["--layout"] = {live.rig.layout};
  ViewerOptions options = options_of(given);
  check(options);
  options.guided = options.no_panels = options.panels = true;
  kinds.sources = task.sources();
  kinds.method = live.own_method;
  const Outputs outputs({{"--json", line.json}, {"--out", line.out}});
  TouchGuide guide(task, line.json);
  show(options, kinds, &guide);
  const std::string summary = guide.end(!options.interact.empty());
  if (setup::shows_summary(options.common, outputs)) write_file("-", summary);
}

}  // namespace palpa::viewer
