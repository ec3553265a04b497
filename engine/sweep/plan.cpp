#include "sweep/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/text.hpp"
#include "sweep/axis.hpp"
#include "sweep/commands.hpp"
#include "sweep/results.hpp"

namespace palpa::sweep {
namespace {

/// 1,000,000
std::string with_commas(std::uint64_t number) {
  const std::string digits = fmt::format("{}", number);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

/// How many values a key of [vary] has.
struct Count {
  std::string key;
  std::uint64_t values = 0;
};

/// The product, or the largest number if it is larger.
std::uint64_t product_of(const std::vector<Count>& counts) {
  std::uint64_t product = 1;
  for (const Count& count : counts) {
    product = product > std::numeric_limits<std::uint64_t>::max() / count.values
                  ? std::numeric_limits<std::uint64_t>::max()
                  : product * count.values;
  }
  return product;
}

/// Refuses an option that two places of the plan set.
void refuse_twice(const Plan& plan) {
  std::map<std::string, std::string> places;
  const auto set = [&](const std::string& option, const std::string& place) {
    const auto [other, is_new] = places.emplace(option, place);
    if (!is_new) {
      throw bad_input(plan.file, fmt::format("{} is set in {} and in {}: set it in one place", option.substr(2),
                                             other->second, place));
    }
  };
  for (const Setting& setting : plan.fixed)
    set(setting.option, "[options]");
  for (const Axis& axis : plan.axes) {
    for (const std::string& option : axis.options)
      set(option, fmt::format("{} of [vary]", axis.key));
  }
}

/// Reads each value by itself, as its option does.
void check_values(const Plan& plan, const Command& command, TomlTable& root) {
  const auto check = [&](const std::string& table, const std::string& key, const Setting& setting) {
    try {
      check_value(command, setting);
    } catch (const Error& error) {
      std::optional<TomlTable> inner = root.table(table);
      throw inner->fault(key, error.what());
    }
  };
  for (const Setting& setting : plan.fixed)
    check("options", setting.option.substr(2), setting);
  for (const Axis& axis : plan.axes) {
    for (const std::vector<Setting>& choice : axis.choices) {
      for (const Setting& setting : choice)
        check("vary", axis.key, setting);
    }
  }
}

/// Before the values are made, because very many of them may not fit into the memory.
void check_count(const std::string& file, TomlTable& root) {
  std::optional<TomlTable> vary = root.table("vary");
  if (!vary) return;
  std::vector<Count> counts;
  for (const std::string& key : vary->keys())
    counts.push_back({key, count_of(vary->value(key))});
  const std::uint64_t count = product_of(counts);
  if (count <= most_cases) return;
  std::vector<std::string> factors;
  factors.reserve(counts.size());
  for (const Count& one : counts)
    factors.push_back(fmt::format("{} {}", with_commas(one.values), printable(one.key, 40)));
  const bool known = count != std::numeric_limits<std::uint64_t>::max();
  throw bad_input(file, fmt::format("has {}{} cases ({}); a plan has at most {}: vary less, or divide it",
                                    known ? "" : "more than ", with_commas(count), fmt::join(factors, " x "),
                                    with_commas(most_cases)));
}

void read_results(TomlTable& root, const Command& command, Plan& plan) {
  const std::string keep = root.text_or("keep", "results");
  if (keep != "results" && keep != "everything") throw root.fault("keep", "keep must be \"results\" or \"everything\"");
  plan.keep_everything = keep == "everything";
  plan.results_given = root.has("results");
  plan.results = plan.results_given ? root.texts("results") : command.results;
  if (plan.results.empty()) throw root.fault("results", "results is empty: name at least one");
  for (const std::string& path : plan.results) {
    if (const std::string fault = path_fault(path); !fault.empty()) throw root.fault("results", fault);
    if (const std::string fault = structure_fault(path, command.structures); !fault.empty())
      throw root.fault("results", fault);
    if (std::ranges::count(plan.results, path) > 1)
      throw root.fault("results", fmt::format("results has {} twice", path));
  }
}

}  // namespace

std::string Setting::shown() const {
  if (values.empty()) return given ? "true" : "false";
  return fmt::format("{}", fmt::join(values, " "));
}

std::uint64_t Plan::count() const {
  std::uint64_t product = 1;
  for (const Axis& axis : axes)
    product *= axis.choices.size();
  return product;
}

std::vector<Setting> Plan::settings(std::uint64_t index) const {
  std::vector<Setting> all = fixed;
  std::vector<const std::vector<Setting>*> chosen(axes.size());
  for (std::size_t a = axes.size(); a-- > 0;) {
    chosen[a] = &axes[a].choices[index % axes[a].choices.size()];
    index /= axes[a].choices.size();
  }
  for (const std::vector<Setting>* choice : chosen)
    all.insert(all.end(), choice->begin(), choice->end());
  return all;
}

std::vector<std::string> Plan::varied() const {
  std::vector<std::string> options;
  for (const Axis& axis : axes)
    options.insert(options.end(), axis.options.begin(), axis.options.end());
  return options;
}

Plan load_plan(const std::string& file) {
  return parse_plan(read_text_file(file, TomlLimits().bytes), file);
}

Plan parse_plan(std::string text, const std::string& file) {
  TomlTable root = TomlTable::parse(text, file, "a plan of a sweep");
  Plan plan;
  plan.file = file;
  plan.folder = std::filesystem::path(file).parent_path().string();
  plan.text = std::move(text);
  plan.command = root.text("command");
  const std::vector<std::string> known = command_names();
  if (std::ranges::find(known, plan.command) == known.end()) {
    throw root.fault("command", fmt::format("command is \"{}\", but must be one of {}", printable(plan.command, 40),
                                            fmt::join(known, ", ")));
  }
  const Command& command = command_of(plan.command);
  read_results(root, command, plan);
  check_count(file, root);
  const auto each = [&](const char* name, const auto& take) {
    std::optional<TomlTable> table = root.table(name);
    if (!table) return;
    for (const std::string& key : table->keys()) {
      const TomlValue value = table->value(key);
      try {
        take(key, value);
      } catch (const ValueFault& fault) {
        throw table->fault(key, fault.text);
      }
    }
  };
  each("options", [&](const std::string& key, const TomlValue& value) {
    plan.fixed.push_back(setting_of(option_of(command.options, key), value));
  });
  each("vary", [&](const std::string& key, const TomlValue& value) {
    plan.axes.push_back(axis_of(command.options, key, value));
  });
  root.done();
  refuse_twice(plan);
  check_values(plan, command, root);
  return plan;
}

setup::Given given_by(const std::vector<Setting>& settings) {
  setup::Given given;
  for (const Setting& setting : settings) {
    if (setting.given) given[setting.option] = setting.values;
  }
  return given;
}

}  // namespace palpa::sweep
