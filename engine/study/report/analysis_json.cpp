#include <cstddef>
#include <cstdint>
#include <optional>

#include "study/files/results_file.hpp"
#include "study/pages/measures_json.hpp"
#include "study/report/reports.hpp"
#include "study/statistics/paired.hpp"

namespace palpa::study {
namespace {

using Style = JsonWriter::Style;

void put_depth(JsonWriter& json, const std::optional<double>& depth_m) {
  constexpr int digits = 6;
  if (depth_m) {
    json.rounded(*depth_m, digits);
  } else {
    json.null();
  }
}

void put_methods(JsonWriter& json, const Analysis& analysis) {
  json.key("methods").begin_array(Style::block);
  for (std::size_t m = 0; m < analysis.results.methods.size(); ++m) {
    const MethodResult& method = analysis.results.methods[m];
    const MethodCourse& course = analysis.courses[m];
    json.begin_object().member("name", method.pooled.name).member("participants", std::uint64_t{method.results.size()});
    json.member("void", method.voids);
    json.key("void_by_shape").begin_array(Style::line);
    for (const std::uint32_t voids : method.void_shapes)
      json.value(voids);
    json.end_array();
    put(json, "mean_accuracy", method.mean_accuracy);
    put(json, "deviation", method.deviation);
    put(json, "t_interval", method.t);
    put(json, "bootstrap_interval", method.bootstrap);
    put_measures(json, method.pooled);
    json.key("learning").begin_object();
    put(json, "block_accuracy", course.learning.block_accuracy);
    put(json, "gain_of_second_half", course.learning.test);
    json.end_object();
    json.key("answer_times").begin_object(Style::line);
    json.member("participants", std::uint64_t{course.times.medians.size()});
    put(json, "median_s", course.times.median_s);
    put(json, "correct_s", course.times.correct_s);
    put(json, "wrong_s", course.times.wrong_s);
    json.end_object();
    if (!course.depths.empty()) {
      json.key("depth").begin_object();
      put(json, "bin_s", DepthCourse::bin_s);
      for (std::size_t shape = 0; shape < course.depths.size(); ++shape) {
        json.key(analysis.study.shapes[shape]).begin_array();
        for (const std::optional<double>& depth : course.depths[shape].depth_m)
          put_depth(json, depth);
        json.end_array();
      }
      json.end_object();
    }
    json.end_object();
  }
  json.end_array();
}

void put_people(JsonWriter& json, const Analysis& analysis) {
  json.key("participants").begin_array(Style::block);
  for (const PersonResult& result : analysis.results.people) {
    json.begin_object(Style::line);
    json.member("participant", analysis.study.participants[result.person].number);
    json.member("method", analysis.study.methods[result.method]).member("turn", result.turn);
    json.member("trials", result.table.total()).member("void", result.voids).member("correct", result.table.correct());
    put(json, "accuracy", result.accuracy);
    put(json, "dprime", result.dprime);
    put(json, "bits", result.bits);
    put(json, "answer_time_s", result.response_s);
    put_counts(json, result.table);
    json.end_object();
  }
  json.end_array();
}

void put_excluded(JsonWriter& json, const Analysis& analysis, const MethodPair& pair) {
  json.key("excluded").begin_array(Style::line);
  for (const std::size_t person : pair.excluded)
    json.value(analysis.study.participants[person].number);
  json.end_array();
  if (!pair.with_excluded) return;
  json.key("with_excluded").begin_object();
  put(json, "mean", pair.mean_with_excluded);
  put(json, "wilcoxon", *pair.with_excluded);
  json.end_object();
}

void put_pairs(JsonWriter& json, const Analysis& analysis) {
  json.key("pairs").begin_array(Style::block);
  for (const MethodPair& pair : analysis.between.pairs) {
    json.begin_object();
    json.member("a", analysis.study.methods[pair.a]).member("b", analysis.study.methods[pair.b]);
    json.member("participants", std::uint64_t{pair.people.size()});
    put(json, "differences", pair.differences);
    put_excluded(json, analysis, pair);
    put(json, "mean", pair.people.empty() ? std::nullopt : std::optional(pair.mean));
    put(json, "t_interval", pair.t);
    put(json, "bootstrap_interval", pair.bootstrap);
    put(json, "cohens_d", pair.cohens_d);
    put(json, "hodges_lehmann", pair.people.empty() ? std::nullopt : std::optional(pair.hodges_lehmann.estimate));
    put(json, "hodges_lehmann_interval", pair.hodges_lehmann.interval);
    put(json, "wilcoxon", pair.drop);
    put(json, "wilcoxon_pratt", pair.pratt);
    put(json, "p_holm", pair.holm);
    put(json, "pearson", pair.pearson);
    put(json, "spearman", pair.spearman);
    json.key("order").begin_object();
    put(json, "differences_a_first", pair.order.a_first);
    put(json, "differences_b_first", pair.order.b_first);
    put(json, "rank_sum", pair.order.test ? std::optional(pair.order.test->sum) : std::nullopt);
    put(json, "p", pair.order.test ? std::optional(pair.order.test->p) : std::nullopt);
    json.end_object();
    put(json, "tables", pair.tables);
    json.end_object();
  }
  json.end_array();
}

}  // namespace

std::string analysis_json(const Analysis& analysis) {
  JsonWriter json;
  json.begin_object().member("kind", results_kind).member("version", 1).member("seed", analysis.seed);
  json.member("resamples", bootstrap_resamples(analysis.study.participants.size()));
  json.key("shapes").begin_array();
  for (const std::string& shape : analysis.study.shapes)
    json.value(shape);
  json.end_array();
  json.member("least_trials", analysis.study.least_trials);
  put_methods(json, analysis);
  put_pairs(json, analysis);
  json.key("friedman");
  if (const auto& friedman = analysis.between.friedman) {
    json.begin_object(Style::line).member("participants", std::uint64_t{friedman->people});
    put(json, "chi_square", friedman->chi_square);
    put(json, "degrees", friedman->degrees);
    put(json, "p", friedman->p);
    json.end_object();
  } else {
    json.null();
  }
  put_people(json, analysis);
  json.key("felt_nothing").begin_array(Style::block);
  for (const Participant& person : analysis.study.participants) {
    if (person.asked == 0) continue;
    json.begin_object(Style::line)
        .member("participant", person.number)
        .member("asked", person.asked)
        .member("felt_nothing", person.unfelt)
        .end_object();
  }
  json.end_array();
  json.key("left_out").begin_array(Style::block);
  for (const std::string& line : analysis.study.left_out)
    json.value(line);
  json.end_array().end_object();
  return json.take();
}

}  // namespace palpa::study
