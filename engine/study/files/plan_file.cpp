#include "study/files/plan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.hpp"
#include "base/toml.hpp"
#include "base/words.hpp"
#include "geometry/haptics.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

std::string next_to(const std::string& plan, const std::string& file) {
  return (fs::path(plan).parent_path() / file).lexically_normal().string();
}

/// A name that reports, logs and tables can hold.
std::string name_of(TomlTable& table) {
  std::string name = table.text("name");
  const auto bad = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7f' || c == ',' || c == '"'; };
  if (name.empty() || name.size() > 60 || std::ranges::any_of(name, bad) || name == "n/a")
    throw table.fault("name", "name must have 1 to 60 bytes, without commas, quotation marks and control characters");
  return name;
}

template <typename Named>
void refuse_twice(const std::vector<Named>& before, const std::string& name, const TomlTable& table) {
  if (std::ranges::find(before, name, &Named::name) != before.end())
    throw table.fault("name", fmt::format("the name '{}' is there twice", printable(name)));
}

PlanMethod method_of(TomlTable& table, const std::string& plan) {
  PlanMethod method;
  method.name = name_of(table);
  const std::string word = table.text_or("method", method.name);
  const auto* const found =
      std::ranges::find(touch::method_words, word, [](const auto& w) { return std::string(w.word); });
  if (found == std::end(touch::method_words)) {
    std::string known;
    for (const auto& entry : touch::method_words)
      known += (known.empty() ? "" : ", ") + std::string(entry.word);
    throw table.fault("method", fmt::format("method is '{}'; known are {}", printable(word), known));
  }
  method.method = found->value;
  if (table.has("foci")) method.foci = static_cast<std::uint32_t>(table.whole("foci", 1, touch::max_foci));
  if (table.has("stride")) {
    method.stride = static_cast<std::uint32_t>(table.whole("stride", 1, 1u << 20));
    if (const std::string fault = geometry::stride_fault(method.foci, *method.stride); !fault.empty())
      throw table.fault("stride", fault);
  }
  method.dwell_s = table.number_or("dwell_ms", method.dwell_s * 1e3, 0.1, 1000) * 1e-3;
  method.modulation_hz = table.number_or("modulation_hz", method.modulation_hz, 1, 1000);
  method.delta_m = table.number_or("delta_mm", method.delta_m * 1e3, 0.01, 100) * 1e-3;
  method.layout = table.text_or("layout", method.layout);
  if (fs::path(method.layout).extension() == ".toml") method.layout = next_to(plan, method.layout);
  table.done();
  return method;
}

PlanObserver observer_of(TomlTable& table) {
  PlanObserver observer;
  const auto ascending = [&](const char* key, std::vector<double>& into, double most) {
    if (!table.has(key)) return;
    std::vector<double> values = table.numbers(key, 0);
    const bool rises = std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
    if (values.empty() || values.size() > 32 || !rises || values.front() <= 0 || values.back() > most) {
      throw table.fault(key,
                        fmt::format("{} must be 1 to 32 numbers above 0, up to {}, in ascending order", key, most));
    }
    for (double& value : values)
      value *= 1e-3;
    into = std::move(values);
  };
  ascending("depths_mm", observer.depths_m, 100);
  ascending("other_crests_mn", observer.other_crests_n, 1000);
  if (table.has("placements")) observer.placements = static_cast<std::uint32_t>(table.whole("placements", 3, 64));
  observer.lateral_m = table.number_or("lateral_mm", observer.lateral_m * 1e3, 0, 20) * 1e-3;
  constexpr double degree = std::numbers::pi / 180;
  observer.yaw_rad = table.number_or("yaw_deg", observer.yaw_rad / degree, 0, 90) * degree;
  observer.crest_n = table.number_or("crest_mn", observer.crest_n * 1e3, 0.1, 1000) * 1e-3;
  table.done();
  return observer;
}

PlanCounts counts_of(TomlTable& table) {
  PlanCounts counts;
  if (table.has("participants")) counts.participants = static_cast<std::uint32_t>(table.whole("participants", 1, 1000));
  if (table.has("trials_per_shape"))
    counts.trials_per_shape = static_cast<std::uint32_t>(table.whole("trials_per_shape", 1, 1000));
  counts.touch_s = table.number_or("touch_s", counts.touch_s, 0.1, 600);
  table.done();
  return counts;
}

PlanFit fit_of(TomlTable& table, const StudyPlan& plan) {
  PlanFit fit;
  const std::string method = table.text("method");
  const auto found = std::ranges::find(plan.methods, method, &PlanMethod::name);
  if (found == plan.methods.end())
    throw table.fault("method", fmt::format("method '{}' is not a [[method]] of the plan", printable(method)));
  fit.method = static_cast<std::size_t>(found - plan.methods.begin());
  fit.trials = static_cast<std::uint32_t>(table.whole("trials", 1, 1'000'000));
  fit.accuracy = table.number("accuracy", 0, 1);
  const double chance = 1 / static_cast<double>(plan.shapes.size());
  if (fit.accuracy <= chance || fit.accuracy >= 1) {
    throw table.fault(
        "accuracy", fmt::format("accuracy must be above {:.3g}, which chance gives with {} shapes, and below 1", chance,
                                plan.shapes.size()));
  }
  table.done();
  return fit;
}

StudyPlan plan_of(TomlTable table, const std::string& name) {
  constexpr std::size_t most_shapes = 16, most_methods = 64;
  StudyPlan plan;
  plan.file = name;
  plan.title = table.text_or("title", "");
  for (TomlTable& one : table.tables("shape")) {
    PlanShape shape{name_of(one), next_to(name, one.text("model"))};
    refuse_twice(plan.shapes, shape.name, one);
    one.done();
    plan.shapes.push_back(std::move(shape));
  }
  if (plan.shapes.size() < 2 || plan.shapes.size() > most_shapes)
    throw table.fault("shape",
                      fmt::format("a plan has 2 to {} [[shape]], this one has {}", most_shapes, plan.shapes.size()));
  for (TomlTable& one : table.tables("method")) {
    PlanMethod method = method_of(one, name);
    refuse_twice(plan.methods, method.name, one);
    plan.methods.push_back(std::move(method));
  }
  for (TomlTable& one : table.tables("candidate")) {
    PlanMethod method = method_of(one, name);
    refuse_twice(plan.methods, method.name, one);
    refuse_twice(plan.candidates, method.name, one);
    plan.candidates.push_back(std::move(method));
  }
  if (plan.methods.empty() || plan.methods.size() + plan.candidates.size() > most_methods) {
    throw table.fault("method", fmt::format("a plan has 1 to {} [[method]] and [[candidate]], this one has {}",
                                            most_methods, plan.methods.size() + plan.candidates.size()));
  }
  if (std::optional<TomlTable> counts = table.table("study")) plan.counts = counts_of(*counts);
  if (std::optional<TomlTable> observer = table.table("observer")) plan.observer = observer_of(*observer);
  std::optional<TomlTable> fit = table.table("fit");
  if (!fit) throw table.fault("fit", "[fit] is missing: the measured accuracy of one method, with its trials");
  plan.fit = fit_of(*fit, plan);
  table.done();
  if (plan.touches() > most_planned_touches) {
    throw table.fault("observer",
                      fmt::format("the observer would have to touch {} times, at most {}: give fewer depths, "
                                  "placements, shapes or methods",
                                  plan.touches(), most_planned_touches));
  }
  return plan;
}

}  // namespace

StudyPlan read_plan(const std::filesystem::path& file) {
  return plan_of(TomlTable::load(file, "a plan of a study"), file.string());
}

StudyPlan parse_plan(const std::string& text, const std::string& name) {
  return plan_of(TomlTable::parse(text, name, "a plan of a study"), name);
}

}  // namespace palpa::study
