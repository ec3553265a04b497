#include "study/plan/plan_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <optional>

#include "base/text.hpp"
#include "geometry/haptics.hpp"

namespace palpa::study {
namespace {

/// The value of a word; throws with the known words.
template <typename Enum, std::size_t count>
Enum word_at(TomlTable& table, const char* key, const Word<Enum> (&words)[count]) {
  const std::string word = table.text(key);
  const std::optional<Enum> value = value_of(words, word);
  if (!value)
    throw table.fault(key, fmt::format("{} is '{}'; it should be {}", key, printable(word, 40), one_of(words)));
  return *value;
}

}  // namespace

std::string next_to(const std::string& plan, const std::string& file) {
  return (std::filesystem::path(plan).parent_path() / file).lexically_normal().string();
}

std::string name_of(TomlTable& table) {
  std::string name = table.text("name");
  const auto bad = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7f' || c == ',' || c == '"'; };
  if (name.empty() || name.size() > 60 || std::ranges::any_of(name, bad) || name == "n/a")
    throw table.fault(
        "name",
        "name must have 1 to 60 bytes, without commas, quotation marks and control characters, and must not be n/a");
  return name;
}

PlanMethod method_of(TomlTable& table, const std::string& plan) {
  PlanMethod method;
  method.name = name_of(table);
  const std::string word = table.text_or("method", method.name);
  const std::optional<touch::Method> known = value_of(touch::method_words, word);
  if (!known) {
    throw table.fault("method",
                      fmt::format("method is '{}'; it should be {}", printable(word), one_of(touch::method_words)));
  }
  method.method = *known;
  if (table.has("foci")) method.foci = static_cast<std::uint32_t>(table.whole("foci", 1, touch::max_foci));
  if (table.has("stride")) {
    method.stride = static_cast<std::uint32_t>(table.whole("stride", 1, 1u << 20));
    if (const std::string fault = geometry::stride_fault(method.foci, *method.stride); !fault.empty())
      throw table.fault("stride", fault);
  }
  method.dwell_s = table.number_or("dwell_ms", method.dwell_s * 1e3, 0.1, 1000) * 1e-3;
  method.modulation_hz = table.number_or("modulation_hz", method.modulation_hz, 1, 1000);
  method.delta_m = table.number_or("delta_mm", method.delta_m * 1e3, 0.01, 100) * 1e-3;
  method.layout_given = table.has("layout");
  method.layout = table.text_or("layout", method.layout);
  if (std::filesystem::path(method.layout).extension() == ".toml") method.layout = next_to(plan, method.layout);
  if (table.has("amplitude")) method.amplitude = word_at(table, "amplitude", array::weighting_words);
  if (table.has("solver")) method.solver = word_at(table, "solver", array::solver_words);
  if (table.has("constraint")) method.constraint = word_at(table, "constraint", array::constraint_words);
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
  counts.touch_s = table.number_or("touch_s", counts.touch_s, 0.01, 600);
  counts.least_trials = table.has("least_trials")
                            ? static_cast<std::uint32_t>(table.whole("least_trials", 0, 1'000'000))
                            : unset_least_trials;
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

PlanRun run_of(TomlTable& table, const StudyPlan& plan) {
  PlanRun run = plan.run;
  const std::size_t methods = plan.methods.size();
  if (table.has("order")) {
    run.order = word_at(table, "order", order_words);
    const bool two = run.order == OrderRule::halves || run.order == OrderRule::alternate;
    if (two && methods != 2) {
      throw table.fault("order", fmt::format("order '{}' is for two methods, and the plan has {}: give {}",
                                             word_of(order_words, run.order), methods,
                                             methods > 2 ? "'williams' or 'fixed'" : "'fixed'"));
    }
    if (run.order == OrderRule::williams && methods < 2)
      throw table.fault("order", "order 'williams' is for two or more methods: give 'fixed'");
  }
  if (table.has("seed")) run.seed = table.whole("seed", 0, 1'000'000'000);
  run.deep_m = table.number_or("deep_mm", run.deep_m * 1e3, 1, 200) * 1e-3;
  run.masking = table.text_or("masking", run.masking);
  if (run.masking.empty()) throw table.fault("masking", "masking should be 'white', 'off' or the name of a sound file");
  if (run.masking != "white" && run.masking != "off") run.masking = next_to(plan.file, run.masking);
  if (table.has("axes")) run.axes = word_at(table, "axes", touch::axes_words);
  if (table.has("smoothing")) run.smoothing = word_at(table, "smoothing", touch::smoothing_words);
  if (table.has("hysteresis")) run.hysteresis = word_at(table, "hysteresis", touch::hysteresis_words);
  run.predict = table.flag_or("predict", run.predict);
  run.ask_depth_frames = table.flag_or("ask_depth_frames", run.ask_depth_frames);
  table.done();
  return run;
}

PlanLevel level_of(TomlTable& table) {
  PlanLevel level;
  level.ceiling = table.number_or("ceiling", level.ceiling, 0, 1);
  level.limit_db = table.number_or("limit_db", level.limit_db, 40, 160);
  const bool measured = table.has("measured_db");
  if (measured != table.has("measured_ceiling")) {
    throw table.fault(measured ? "measured_db" : "measured_ceiling",
                      "measured_db and measured_ceiling go together: what a microphone read, and at which ceiling");
  }
  if (measured) {
    level.measured_db = table.number("measured_db", 0, 200);
    level.measured_ceiling = table.number("measured_ceiling", 1e-3, 1);
  }
  const char* const keys[]{"left_ear_mm", "right_ear_mm"};
  for (std::size_t side = 0; side < 2; ++side) {
    if (!table.has(keys[side])) continue;
    const std::vector<double> mm = table.numbers(keys[side], 3);
    for (const double v : mm) {
      if (std::abs(v) > 1e4) throw table.fault(keys[side], fmt::format("{} is more than 10 m away", keys[side]));
    }
    level.ears[side] = Vec3(mm[0], mm[1], mm[2]) * 1e-3;
  }
  table.done();
  return level;
}

PlanBlock block_of(TomlTable& table, const StudyPlan& plan) {
  PlanBlock block;
  block.kind = word_at(table, "kind", block_words);
  const std::string kind(word_of(block_words, block.kind));
  const bool asked = asks(block.kind);
  const auto refuse = [&](const char* key, bool fits) {
    if (!fits && table.has(key)) throw table.fault(key, fmt::format("{} has no effect in a block '{}'", key, kind));
  };
  const bool rest = block.kind == BlockKind::rest, free = block.kind == BlockKind::free;
  refuse("shapes", !rest);
  refuse("repeats", asked);
  refuse("feedback", asked);
  refuse("apart", block.kind == BlockKind::trial);

  if (table.has("shapes")) {
    for (const std::string& name : table.texts("shapes")) {
      const auto found = std::ranges::find(plan.shapes, name, &PlanShape::name);
      if (found == plan.shapes.end())
        throw table.fault("shapes", fmt::format("'{}' is not a [[shape]] of the plan", printable(name, 40)));
      const auto index = static_cast<std::uint32_t>(found - plan.shapes.begin());
      // A shape may be practised twice; in the other blocks, repeats says how often.
      if (block.kind != BlockKind::practice && std::ranges::find(block.shapes, index) != block.shapes.end())
        throw table.fault("shapes", fmt::format("'{}' is there twice", printable(name, 40)));
      block.shapes.push_back(index);
    }
    if (block.shapes.empty() || block.shapes.size() > 64) throw table.fault("shapes", "shapes must be 1 to 64 names");
  } else if (!rest) {
    for (std::uint32_t i = 0; i < plan.shapes.size(); ++i)
      block.shapes.push_back(i);
  }
  const std::size_t needed = block.kind == BlockKind::trial ? 2 : 1;
  if (!rest && block.shapes.size() < needed)
    throw table.fault("shapes", fmt::format("a block '{}' needs at least {} shapes", kind, needed));

  if (block.kind == BlockKind::trial) block.repeats = plan.counts.trials_per_shape;
  if (table.has("repeats")) block.repeats = static_cast<std::uint32_t>(table.whole("repeats", 1, 1000));
  constexpr double free_s = 180, rest_s = 60;
  block.touch_s = free ? free_s : rest ? rest_s : plan.counts.touch_s;
  block.touch_s = table.number_or(rest ? "rest_s" : "touch_s", block.touch_s, 0.01, 3600);
  block.feedback = table.flag_or("feedback", false);
  block.apart = table.flag_or("apart", false);
  block.once = table.flag_or("once", false);
  if (table.has("text")) block.text = table.text("text");
  table.done();
  return block;
}

std::vector<PlanBlock> default_blocks(const StudyPlan& plan) {
  std::vector<std::uint32_t> all(plan.shapes.size());
  for (std::uint32_t i = 0; i < all.size(); ++i)
    all[i] = i;
  const auto semi = std::ranges::find(plan.shapes, std::string("semi-sphere"), &PlanShape::name);
  const auto practised = static_cast<std::uint32_t>(semi == plan.shapes.end() ? 0 : semi - plan.shapes.begin());
  return {{.kind = BlockKind::familiarise, .shapes = all, .touch_s = plan.counts.touch_s},
          {.kind = BlockKind::free, .shapes = all, .touch_s = 180},
          {.kind = BlockKind::practice, .shapes = {practised}, .touch_s = plan.counts.touch_s},
          {.kind = BlockKind::trial,
           .shapes = all,
           .repeats = plan.counts.trials_per_shape,
           .touch_s = plan.counts.touch_s}};
}

void texts_of(TomlTable& table, StudyPlan& plan) {
  for (const std::string& language : table.keys()) {
    const auto lower = [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; };
    if (language.size() < 2 || language.size() > 16 || !std::ranges::all_of(language, lower))
      throw table.fault(language, fmt::format("'{}' is not a language, such as en or de", printable(language, 40)));
    std::optional<TomlTable> own = table.table(language);
    for (const DefaultText& text : default_texts()) {
      if (own->has(text.key)) plan.texts[language][text.id] = own->text(text.key);
    }
    own->done();
  }
  table.done();
}

}  // namespace palpa::study
