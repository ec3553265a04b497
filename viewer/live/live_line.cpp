#include "viewer/live/live_line.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <string_view>

#include "setup/values.hpp"

namespace palpa::viewer {
namespace {

void add_options(CLI::App& app, setup::LiveOptions& o) {
  const setup::Group group(app, "What to run");
  add_frame_options(group, o, "stop after that many frames; 0: at the source's end");
  add_link_options(group, o);
  add_session_options(app, o);
  setup::add_common(app, o.common);
}

bool of_terminals(const std::string& name) {
  constexpr std::string_view names[] = {"--json", "--quiet", "--log-level", "--frames"};
  return std::ranges::find(names, name) != std::end(names);
}

}  // namespace

const std::vector<setup::OptionInfo>& live_table() {
  static const std::vector<setup::OptionInfo> table = [] {
    CLI::App app("", "palpa-viewer");
    setup::LiveOptions options;
    add_options(app, options);
    std::vector<setup::OptionInfo> all = setup::option_table(app);
    std::erase_if(all, [](const setup::OptionInfo& info) { return of_terminals(info.name); });
    return all;
  }();
  return table;
}

setup::LiveOptions live_options(const setup::Given& given) {
  CLI::App app("", "palpa-viewer");
  setup::LiveOptions options;
  add_options(app, options);
  setup::parse_given(app, setup::known_to(live_table(), given));
  check(options);
  return options;
}

std::string run_command(const setup::Given& given) {
  setup::Given there = given;
  // A pointer is not there: the same finger dips by itself.
  if (const auto source = there.find("--source"); source != there.end() && !source->second.empty()) {
    std::string& name = source->second.front();
    if (name == "mouse" || name.starts_with("mouse:")) name.replace(0, 5, "synthetic");
  }
  return setup::command_line("palpa run", live_table(), there);
}

}  // namespace palpa::viewer
