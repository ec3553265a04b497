#include "viewer/live/live_line.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <iterator>
#include <string_view>

#include "setup/values.hpp"

namespace palpa::viewer {
namespace {

struct LineOptions : setup::LiveOptions {
  setup::StatsFormat stats = setup::StatsFormat::none;
};

void add_options(CLI::App& app, LineOptions& o) {
  const setup::Group group(app, "What to run");
  add_frame_options(group, o, "stop after that many frames; 0: at the source's end");
  add_link_options(group, o);
  setup::add_stats_option(group, o.stats);
  add_session_options(app, o);
  setup::add_common(app, o.common);
}

bool is_told(const setup::OptionInfo& info) {
  constexpr std::string_view names[] = {"--frames", "--stats", "--json", "--quiet", "--log-level"};
  return std::ranges::find(names, info.name) != std::end(names);
}

const std::vector<setup::OptionInfo>& whole_table() {
  static const std::vector<setup::OptionInfo> table = [] {
    CLI::App app("", "palpa-viewer");
    LineOptions options;
    add_options(app, options);
    return setup::option_table(app);
  }();
  return table;
}

std::vector<setup::OptionInfo> part_of_table(bool told) {
  std::vector<setup::OptionInfo> part;
  std::ranges::copy_if(whole_table(), std::back_inserter(part),
                       [&](const setup::OptionInfo& info) { return is_told(info) == told; });
  return part;
}

LineOptions parsed(const setup::Given& given) {
  CLI::App app("", "palpa-viewer");
  LineOptions options;
  add_options(app, options);
  setup::parse_given(app, given);
  return options;
}

}  // namespace

const std::vector<setup::OptionInfo>& live_table() {
  static const std::vector<setup::OptionInfo> table = part_of_table(false);
  return table;
}

const std::vector<setup::OptionInfo>& told_table() {
  static const std::vector<setup::OptionInfo> table = part_of_table(true);
  return table;
}

setup::LiveOptions live_options(const setup::Given& given) {
  setup::LiveOptions options = parsed(setup::known_to(live_table(), given));
  options.watched = true;  // the viewer itself shows events
  check(options);
  return options;
}

void check_told(const setup::Given& told) {
  parsed(setup::known_to(told_table(), told));
}

std::string run_command(const setup::Given& given, const setup::Given& told) {
  setup::Given there = setup::known_to(live_table(), given);
  there.merge(setup::known_to(told_table(), told));
  // A pointer is not there: the same finger dips by itself.
  if (const auto source = there.find("--source"); source != there.end() && !source->second.empty()) {
    std::string& name = source->second.front();
    if (name == "mouse" || name.starts_with("mouse:")) name.replace(0, 5, "synthetic");
  }
  return setup::command_line("palpa run", whole_table(), there);
}

}  // namespace palpa::viewer
