#include "viewer/live/live_line.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <iterator>
#include <mutex>
#include <string_view>

#include "base/error.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "viewer/live/held_finger.hpp"

namespace palpa::viewer {
namespace {

using setup::RunCommand;

/// The viewer reads a saved scene again also without --reload.
void add_live_options(CLI::App& app, RunCommand& o) {
  setup::add_run_options(app, o, "stop after that many frames; 0: at the source's end");
  setup::add_common(app, o.common);
}

bool is_copied(const line::OptionInfo& info) {
  constexpr std::string_view names[] = {"--frames", "--stats", "--reload", "--json", "--quiet", "--log-level"};
  return std::ranges::find(names, info.name) != std::end(names);
}

/// Every option with the parser of its text. Made once, because a panel reads texts again and again.
class Reader {
 public:
  Reader() { add_live_options(app_, options_); }
  RunCommand read(const line::Given& given) {
    options_ = RunCommand();  // an option that is not given has its default, whatever it was before
    line::read_given(app_, given);
    return options_;
  }
  std::vector<line::OptionInfo> table() const { return line::option_table(app_); }
  std::string misfit(const line::Given& given) const { return line::misfit(app_, given); }

 private:
  CLI::App app_{"", "palpa-viewer"};
  RunCommand options_;  ///< the app's options are read into this
};

Reader& reader() {
  static Reader one;
  return one;
}

RunCommand read(const line::Given& given) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  return reader().read(given);
}

const std::vector<line::OptionInfo>& whole_table() {
  static const std::vector<line::OptionInfo> table = reader().table();
  return table;
}

std::vector<line::OptionInfo> part_of_table(bool copied) {
  std::vector<line::OptionInfo> part;
  std::ranges::copy_if(whole_table(), std::back_inserter(part),
                       [&](const line::OptionInfo& info) { return is_copied(info) == copied; });
  return part;
}

}  // namespace

const std::vector<line::OptionInfo>& live_table() {
  static const std::vector<line::OptionInfo> table = part_of_table(false);
  return table;
}

const std::vector<line::OptionInfo>& copied_table() {
  static const std::vector<line::OptionInfo> table = part_of_table(true);
  return table;
}

setup::LiveOptions values_of(const line::Given& given) {
  setup::LiveOptions options = read(line::known_to(live_table(), given));
  options.watched = true;  // the viewer itself shows events
  return options;
}

void check_live(const line::Given& given, const setup::LiveOptions& options) {
  if (const std::string fault = reader().misfit(line::known_to(live_table(), given)); !fault.empty())
    throw bad_usage(fault);
  check(options);
}

setup::LiveOptions live_options(const line::Given& given) {
  setup::LiveOptions options = values_of(given);
  check_live(given, options);
  return options;
}

void check_copied(const line::Given& copied) {
  read(line::known_to(copied_table(), copied));
}

std::string run_command(const line::Given& given, const line::Given& copied) {
  line::Given there = line::known_to(live_table(), given);
  there.merge(line::known_to(copied_table(), copied));
  HeldFinger::without_hand(there);
  return line::command_line("palpa run", whole_table(), there);
}

}  // namespace palpa::viewer
