// Exactly at a limit: the last value of each option's range passes, the next is refused, and so is no number.
// docs/limits.md says the same ranges, and each of its rows is tried here or is known not to be.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/units.hpp"
#include "cli/command.hpp"
#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "line/option_table.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

/// Bounds that an option's refusal names; none: there is no bound on that side.
struct Bounds {
  std::optional<double> low, high;
  bool open = false, whole = false;
};

double number_of(const std::string& text) {
  static constexpr Quantity quantities[] = {Quantity::length, Quantity::time, Quantity::frequency, Quantity::speed,
                                            Quantity::pressure};
  for (const Quantity quantity : quantities) {
    if (const auto value = parse_quantity(text, quantity)) return *value;
  }
  throw failure("no number: " + text);
}

std::optional<Bounds> bounds_in(const std::string& refusal) {
  static const std::regex from(R"(from (\S+) to ([^\s,]+))"), above(R"(above (\S+), at most (\S+)$)"),
      no_more(R"((above|at least) (\S+)$)");
  std::smatch found;
  if (std::regex_search(refusal, found, from)) {
    const bool whole = refusal.find("whole number") != std::string::npos;
    return Bounds{number_of(found[1]), number_of(found[2]), false, whole};
  }
  if (std::regex_search(refusal, found, above)) return Bounds{number_of(found[1]), number_of(found[2]), true};
  if (std::regex_search(refusal, found, no_more)) return Bounds{number_of(found[2]), std::nullopt, found[1] == "above"};
  return std::nullopt;
}

/// The value, and its neighbours in the option's kind of number.
struct Near {
  std::string before, value, after;
};

Near near(double value, bool whole) {
  constexpr double all = std::numeric_limits<double>::infinity();
  if (!whole)
    return {fmt::format("{}", std::nextafter(value, -all)), fmt::format("{}", value),
            fmt::format("{}", std::nextafter(value, all))};
  if (value > 9e18) return {"18446744073709551614", "18446744073709551615", "18446744073709551616"};  // 64 bits
  const auto number = static_cast<std::int64_t>(value);
  return {fmt::format("{}", number - 1), fmt::format("{}", number), fmt::format("{}", number + 1)};
}

/// The ranges of all numeric options of all commands, "touch --delta", and options whose refusals name none.
struct Ranges {
  std::map<std::string, Bounds> of;
  std::set<std::string> without;
  std::vector<std::string> faults;
  int no_numbers = 0;  ///< values that were tried
};

class AtTheLimits {
 public:
  explicit AtTheLimits(Ranges& ranges) : ranges_(ranges) {}

  void all_of(CLI::App& app, const std::string& words) {
    for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
      all_of(*command, words + command->get_name() + " ");
    for (const line::OptionInfo& option : line::option_table(app))
      try_option(app, words, option);
  }

 private:
  static std::string refusal(CLI::App& app, const std::string& option, const std::string& value) {
    return error_of([&] { line::read_given(app, {{option, {value}}}); }, Exit::usage);
  }

  void try_option(CLI::App& app, const std::string& words, const line::OptionInfo& option) {
    for (const char* none : {"nan", "-nan", "inf", "-inf"}) {
      for (const std::string& value : odd_values(option.type, none)) {
        std::vector<std::string> values{value};
        if (option.name == "--line") values.emplace_back("0,0,10mm");
        const std::string line = error_of([&] { line::read_given(app, {{option.name, values}}); }, Exit::usage);
        ++ranges_.no_numbers;
        if (line.find(option.name) == std::string::npos)
          ranges_.faults.push_back(fmt::format("{}{} {}: {}", words, option.name, value, line));
      }
    }
    if (odd_values(option.type, "1").size() != 1) return;
    std::optional<Bounds> bounds;
    for (const char* far : {"-1e299", "1e299"}) {
      if (!bounds) bounds = bounds_in(refusal(app, option.name, far));
    }
    const std::string name = words + option.name;
    if (!bounds) {
      ranges_.without.insert(name);
      return;
    }
    ranges_.of[name] = *bounds;
    // What a test says during palpa_here is lost, so it is kept.
    const auto passes = [&](const std::string& value) {
      const std::string line = refusal(app, option.name, value);
      if (!line.empty()) ranges_.faults.push_back(fmt::format("{} {} is refused: {}", name, value, line));
    };
    const auto is_refused = [&](const std::string& value) {
      if (refusal(app, option.name, value).empty()) ranges_.faults.push_back(fmt::format("{} {} passes", name, value));
    };
    if (bounds->low) {
      const Near low = near(*bounds->low, bounds->whole);
      passes(bounds->open ? low.after : low.value);
      is_refused(bounds->open ? low.value : low.before);
    }
    if (bounds->high) {
      const Near high = near(*bounds->high, bounds->whole);
      passes(high.value);
      is_refused(high.after);
    }
  }

  Ranges& ranges_;
};

const Ranges& ranges() {
  static const Ranges all = [] {
    Ranges found;
    palpa_here({"--version"}, {}, [&](cli::Extensions& extensions) {
      extensions.commands.emplace_back([&](cli::Program& program) { AtTheLimits(found).all_of(program.app, ""); });
    });
    return found;
  }();
  return all;
}

TEST(AtALimit, TheLastValueOfAnOptionPassesAndTheNextIsRefused) {
  EXPECT_GT(ranges().of.size(), 150u);
  EXPECT_GT(ranges().no_numbers, 900);
  EXPECT_EQ(ranges().faults, std::vector<std::string>{}) << testing::PrintToString(ranges().faults);
  // Their own parsers read them.
  EXPECT_EQ(ranges().without, std::set<std::string>{}) << testing::PrintToString(ranges().without);
}

/// A row of a table of docs/limits.md: what is limited -> at most.
std::map<std::string, std::string> rows_of_the_page() {
  std::map<std::string, std::string> rows;
  std::istringstream page(read_text(source_file("docs/limits.md")));
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| ") || line.starts_with("| what |")) continue;
    const std::size_t bar = line.find(" | ");
    rows[line.substr(2, bar - 2)] = line.substr(bar + 3, line.size() - bar - 5);
  }
  return rows;
}

struct Said {
  const char *row, *command, *option;
  const char *low, *high;  ///< as the row says them; empty: it says none
  double low_value, high_value;
};

constexpr Said said[] = {
    {"`--temperature`", "drive", "--temperature", "-60 to ", "100 degrees Celsius", -60, 100},
    {"`--sound-speed`", "drive", "--sound-speed", "100 to ", "2,000 m/s", 100, 2000},
    {"`--frequency`, a layout's `frequency_hz`", "drive", "--frequency", "1 kHz to ", "10 MHz", 1e3, 1e7},
    {"`--humidity`, `--air-pressure`", "field", "--humidity", "0 to ", "100 %", 0, 100},
    {"`--humidity`, `--air-pressure`", "field", "--air-pressure", "20 to ", "500 kPa", 2e4, 5e5},
    {"`--dwell` of `palpa play`; a sensation's brushes and modulations", "play", "--dwell", "0.05 ms to ", "50 ms",
     5e-5, 0.05},
    {"`--dwell`, a solid's `dwell_s`", "touch", "--dwell", "1 us to ", "10 s", 1e-6, 10},
    {"`--predict-latency`, and any prediction", "run", "--predict-latency", "", "60 ms", 0, 0.06},
    {"`--hold`, `--ramp`", "run", "--hold", "", "10 s", 0, 10},
    {"`--hold`, `--ramp`", "run", "--ramp", "", "0.5 s", 0, 0.5},
    {"`--modulation-frequency`", "touch", "--modulation-frequency", "", "1 kHz", 0, 1000},
};

// These rows are not tried here.
const std::set<std::string> not_tried{
    // Their last value costs seconds or memory, or a file as large as it may be.
    "JSON", "nodes, meshes, primitives, accessors, ...", "buffers, packed and unpacked together",
    "triangles; vertices; each instance counts", "vertices moved by morph targets",
    "pairs of triangles with overlapping boxes", "data in draco streams",
    "steps to fill the grid of a surface or of parts", "parts of one solid",
    "pixels of all cameras together, rows padded to 8", "a camera's image", "rays for a picture of it", "a PNG",
    "a rig", "a layout", "`recording.toml`", "`times.csv`", "a touch (`palpa drive --touch`)",
    "a pattern (`palpa drive --pattern`)", "a pattern of Adaptics (`palpa play`)",
    "slots of a sensation in a table, a picture or a record", "hands of a tracker (`--source joints:`)",
    "a file of a tracker's lines", "a PLY", "the points of `palpa field`",
    "the body of `palpa scatter` and `palpa simulate`", "participants; logs of each; methods; shapes (in a plan: 16)",
    "a log (`_events.tsv`)", "a recording of the finger",
    "the JSON beside a log; a table of counts; a JSON of `palpa study analyse`", "a plan, for `palpa study simulate`",
    "`palpa study power`",
    // Values in files and lists: their readers' tests are beside the readers.
    "a solid's size", "rows of a stiffness", "cameras of a rig", "a synthetic source's mesh",
    "a room, `low_m` and `high_m`", "`background_margin_m`", "distortion", "a camera's `exposure_s`",
    "a file that a model or a recording names", "a point source of `palpa scatter`, and other points that options name",
    "a point source of `palpa scatter`", "a phase in the file of `--drive`", "a focus of `palpa drive`",
    "nulls (`--null`)", "a count; a name of a shape or method", "the time at which a sensation starts, and its delay",
    "`measured_db`, `measured_ceiling` of a plan's `[level]`",
    // The limit depends on another option.
    "frames of `palpa calibrate --background`", "`palpa calibrate --frames`",
    // Not a refusal.
    "differences up to which Wilcoxon's test is exact", "surfaces in exactly the same place, in the viewer",
    "solids of a scene, on the software device of a Mesa version before 25", "the loaded program",
    "a software device (Mesa's lavapipe)", "`--backend cpu`, or no GPU", "scattering, which loads OpenBLAS"};

TEST(AtALimit, ThePageSaysTheRangesOfTheOptions) {
  std::set<std::string> left;
  const auto rows = rows_of_the_page();
  for (const auto& [row, most] : rows)
    left.insert(row);
  for (const Said& s : said) {
    SCOPED_TRACE(std::string(s.row) + " " + s.command + " " + s.option);
    ASSERT_TRUE(rows.contains(s.row)) << "no such row";
    left.erase(s.row);
    EXPECT_CONTAINS(rows.at(s.row), std::string(s.low) + s.high);
    const auto found = ranges().of.find(std::string(s.command) + " " + s.option);
    ASSERT_NE(found, ranges().of.end()) << "no such option";
    EXPECT_EQ(found->second.high, s.high_value);
    if (s.low[0] != '\0') {
      EXPECT_EQ(found->second.low, s.low_value);
    }
  }
  EXPECT_EQ(left, not_tried) << "a row is tried here, or has a reason why it is not";
}

}  // namespace
}  // namespace palpa::test
