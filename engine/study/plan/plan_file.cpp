#include "study/plan/plan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/outputs.hpp"
#include "base/files/sha256.hpp"
#include "base/files/toml.hpp"
#include "base/text.hpp"
#include "study/plan/order.hpp"
#include "study/plan/plan_tables.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* what = "a plan of a study";

template <typename Named>
void refuse_twice(const std::vector<Named>& before, const std::string& name, const TomlTable& table) {
  if (std::ranges::find(before, name, &Named::name) != before.end())
    throw table.fault("name", fmt::format("the name '{}' is there twice", printable(name)));
}

void read_shapes(TomlTable& table, StudyPlan& plan) {
  constexpr std::size_t most_shapes = 16;
  for (TomlTable& one : table.tables("shape")) {
    const std::string model = one.text("model");
    PlanShape shape{name_of(one), is_own_model(model) ? model : next_to(plan.file, model)};
    refuse_twice(plan.shapes, shape.name, one);
    if (std::optional<TomlTable> labels = one.table("labels")) {
      for (const std::string& language : labels->keys())
        shape.labels[language] = labels->text(language);
    }
    one.done();
    plan.shapes.push_back(std::move(shape));
  }
  if (plan.shapes.size() < 2 || plan.shapes.size() > most_shapes)
    throw table.fault("shape",
                      fmt::format("a plan has 2 to {} [[shape]], this one has {}", most_shapes, plan.shapes.size()));
}

void read_methods(TomlTable& table, StudyPlan& plan) {
  constexpr std::size_t most_methods = 64;
  for (TomlTable& one : table.tables("method")) {
    PlanMethod method = method_of(one, plan.file);
    refuse_twice(plan.methods, method.name, one);
    plan.methods.push_back(std::move(method));
  }
  for (TomlTable& one : table.tables("candidate")) {
    PlanMethod method = method_of(one, plan.file);
    refuse_twice(plan.methods, method.name, one);
    refuse_twice(plan.candidates, method.name, one);
    plan.candidates.push_back(std::move(method));
  }
  if (plan.methods.empty() || plan.methods.size() + plan.candidates.size() > most_methods) {
    throw table.fault("method", fmt::format("a plan has 1 to {} [[method]] and [[candidate]], this one has {}",
                                            most_methods, plan.methods.size() + plan.candidates.size()));
  }
}

/// A language other than English must have a text for every screen: half a page in another language helps nobody.
void refuse_missing_texts(TomlTable& table, const StudyPlan& plan) {
  if (plan.language == "en") return;
  const auto own = plan.texts.find(plan.language);
  if (own == plan.texts.end()) {
    throw table.fault("language", fmt::format("language is '{0}', but there is no [texts.{0}]", plan.language));
  }
  for (const DefaultText& text : default_texts()) {
    if (!text.optional && !own->second.contains(text.id))
      throw table.fault("texts", fmt::format("[texts.{}] has no {}: give every text", plan.language, text.key));
  }
}

/// Counts are read before the blocks that they bound.
void settle_least_trials(const TomlTable& table, StudyPlan& plan) {
  std::uint32_t& least = plan.counts.least_trials;
  if (least == unset_least_trials) least = default_least_trials(plan);
  if (const std::uint32_t all = trials_of_method(plan); least > all) {
    throw table.fault("study", fmt::format("[study] least_trials is {}, but a participant has only {} with each method",
                                           least, counted(all, "trial")));
  }
}

StudyPlan plan_of(TomlTable table, const std::string& name, const std::string& text) {
  StudyPlan plan;
  plan.file = name;
  plan.sha256 = sha256(text);
  plan.title = table.text_or("title", "");
  plan.counts.least_trials = unset_least_trials;
  read_shapes(table, plan);
  read_methods(table, plan);
  if (std::optional<TomlTable> counts = table.table("study")) plan.counts = counts_of(*counts);
  plan.run.order = default_order(plan.methods.size());
  if (std::optional<TomlTable> run = table.table("run")) plan.run = run_of(*run, plan);
  if (std::optional<TomlTable> level = table.table("level")) plan.level = level_of(*level);
  for (TomlTable& one : table.tables("block"))
    plan.blocks.push_back(block_of(one, plan));
  if (plan.blocks.empty()) plan.blocks = default_blocks(plan);
  settle_least_trials(table, plan);
  plan.language = table.text_or("language", plan.language);
  if (std::optional<TomlTable> texts = table.table("texts")) texts_of(*texts, plan);
  refuse_missing_texts(table, plan);
  if (std::optional<TomlTable> observer = table.table("observer")) plan.observer = observer_of(*observer);
  if (std::optional<TomlTable> fit = table.table("fit")) plan.fit = fit_of(*fit, plan);
  table.done();
  if (plan.touches() > most_planned_touches) {
    throw table.fault("observer",
                      fmt::format("the observer would have to touch {} times, at most {}: give fewer depths, "
                                  "placements, shapes or methods",
                                  plan.touches(), most_planned_touches));
  }
  if (const std::size_t steps = count_steps(plan); steps > most_planned_steps) {
    throw table.fault("block", fmt::format("a participant would have {} steps, at most {}: give fewer repeats", steps,
                                           most_planned_steps));
  }
  if (const double seconds = sounding_s(plan); seconds > most_sounding_s) {
    throw table.fault("block", fmt::format("a participant would touch for {:.1f} hours, at most {:.0f}: give fewer or "
                                           "shorter trials",
                                           seconds / 3600, most_sounding_s / 3600));
  }
  return plan;
}

/// Remembers it as an input, so that no output replaces it.
bool is_file(const std::string& name) {
  refuse_output_as_input(name);
  std::error_code fault;
  return fs::is_regular_file(name, fault);
}

}  // namespace

StudyPlan read_plan(const fs::path& file) {
  return parse_plan(read_file(file, TomlLimits().bytes), file.string());
}

StudyPlan parse_plan(const std::string& text, const std::string& name) {
  return plan_of(TomlTable::parse(text, name, what), name, text);
}

void refuse_without_fit(const StudyPlan& plan) {
  if (plan.fit.trials == 0)
    throw bad_input(plan.file, "[fit] is missing: the measured accuracy of one method, with its trials");
}

void refuse_missing_files(const StudyPlan& plan) {
  for (const PlanShape& shape : plan.shapes) {
    if (!is_file(shape.model))
      throw bad_input(plan.file, fmt::format("the model of '{}' is missing: there is no file {}", printable(shape.name),
                                             printable(shape.model)));
  }
  for (const std::vector<PlanMethod>& methods : {plan.methods, plan.candidates}) {
    for (const PlanMethod& method : methods) {
      if (fs::path(method.layout).extension() == ".toml") refuse_output_as_input(method.layout);
      if (!array::is_layout(method.layout)) {
        throw bad_input(plan.file,
                        fmt::format("the layout of '{}' is '{}'; it should be a layout file, or one of {}",
                                    printable(method.name), printable(method.layout), array::known_layouts()));
      }
    }
  }
  const std::string& masking = plan.run.masking;
  if (masking != "white" && masking != "off" && !is_file(masking))
    throw bad_input(plan.file, fmt::format("the masking sound is missing: there is no file {}", printable(masking)));
}

}  // namespace palpa::study
