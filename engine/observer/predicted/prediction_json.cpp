#include <optional>

#include "base/files/json_writer.hpp"
#include "observer/predicted/prediction_reports.hpp"
#include "study/pages/measures_json.hpp"

namespace palpa::observer {
namespace {

using study::Interval;
using study::put;

constexpr int prediction_digits = 6;

void put_strings(JsonWriter& json, const char* key, const std::vector<std::string>& texts) {
  json.key(key).begin_array(JsonWriter::Style::line);
  for (const std::string& text : texts)
    json.value(text);
  json.end_array();
}

void put_short(JsonWriter& json, const char* key, double value) {
  json.key(key).rounded(value, prediction_digits);
}

void put_short(JsonWriter& json, const char* key, const std::optional<Interval>& interval) {
  json.key(key);
  if (interval) {
    json.begin_array(JsonWriter::Style::line)
        .rounded(interval->low, prediction_digits)
        .rounded(interval->high, prediction_digits)
        .end_array();
  } else {
    json.null();
  }
}

void put_variant(JsonWriter& json, const Prediction& p, const PredictedVariant& variant) {
  json.begin_object().member("name", variant.name).member("what", variant.what);
  put_short(json, "sigma", variant.sigma);
  json.key("methods").begin_array(JsonWriter::Style::block);
  for (std::size_t m = 0; m < variant.methods.size(); ++m) {
    const PredictedMethod& method = variant.methods[m];
    json.begin_object(JsonWriter::Style::line).member("method", p.methods[m]);
    put_short(json, "accuracy", method.accuracy);
    put_short(json, "fitted_interval", method.fitted_interval);
    put_short(json, "error", method.error);
    json.key("shares").begin_array();
    for (std::size_t i = 0; i < p.shapes.size(); ++i) {
      json.begin_array();
      for (std::size_t j = 0; j < p.shapes.size(); ++j)
        json.rounded(method.shares[i * p.shapes.size() + j], prediction_digits);
      json.end_array();
    }
    json.end_array().end_object();
  }
  json.end_array().end_object();
}

void put_prediction(JsonWriter& json, const Prediction& p) {
  json.begin_object().member("version", 1);
  put_strings(json, "shapes", p.shapes);
  put_strings(json, "methods", p.methods);
  json.key("depths_m").value(p.depths_m).member("placements", p.placements);
  const PredictedStudy& study = p.study;
  json.member("participants", study.observers).member("trials_per_shape", study.trials_per_shape);
  json.member("touch_s", study.touch_s).member("seed", study.seed).key("fitted").begin_object(JsonWriter::Style::line);
  json.member("method", p.methods[study.fitted.method]).member("accuracy", study.fitted.accuracy);
  json.member("trials", study.fitted.trials);
  put_short(json, "interval", std::optional(p.fitted_interval));
  json.end_object().key("variants").begin_array(JsonWriter::Style::block);
  for (const PredictedVariant& variant : p.variants)
    put_variant(json, p, variant);
  json.end_array().key("levels").begin_array(JsonWriter::Style::block);
  for (const PredictedLevel& level : p.levels) {
    json.begin_object().member("name", level.level.name);
    put_short(json, "factor", level.level.factor);
    put_short(json, "crest_n", level.level.force_n);
    json.key("prediction");
    put_variant(json, p, level.prediction);
    json.end_object();
  }
  json.end_array().key("plan_level");
  if (p.at_plan) {
    json.begin_object();
    put_short(json, "ceiling", p.at_plan->level.plan_ceiling.value_or(1));
    put_short(json, "factor", p.at_plan->level.factor);
    put_short(json, "crest_n", p.at_plan->level.force_n);
    json.key("prediction");
    put_variant(json, p, p.at_plan->prediction);
    json.end_object();
  } else {
    json.null();
  }
  json.key("nulls").begin_array(JsonWriter::Style::block);
  for (const PredictedVariant& null : p.nulls)
    put_variant(json, p, null);
  json.end_array().key("ranking").begin_array(JsonWriter::Style::block);
  for (const RankedMethod& entry : p.ranking) {
    json.begin_object(JsonWriter::Style::line).member("method", p.methods[entry.method]).member("rank", entry.rank);
    put_short(json, "accuracy", entry.accuracy);
    put_short(json, "variants", std::optional(Interval{entry.low, entry.high}));
    put_short(json, "to_best", entry.to_best);
    put_short(json, "spread", entry.spread);
    json.end_object();
  }
  json.end_array().key("studies").begin_array(JsonWriter::Style::block);
  for (std::size_t m = 0; m < p.studies.size(); ++m) {
    json.begin_object(JsonWriter::Style::line).member("method", p.methods[m]);
    put_short(json, "accuracy", std::optional(p.studies[m]));
    json.end_object();
  }
  json.end_array().end_object();
}

void put_fit(JsonWriter& json, const std::string& name, const TableFit& fit) {
  json.begin_object(JsonWriter::Style::line).member("name", name);
  put(json, "rms", fit.rms);
  put(json, "errors_r", fit.errors_r);
  put(json, "log_likelihood", fit.log_likelihood);
  json.end_object();
}

}  // namespace

std::string prediction_document(const Prediction& prediction) {
  JsonWriter json;
  put_prediction(json, prediction);
  return json.take();
}

std::string prediction_json(const Prediction& p, const Comparison& comparison, const std::string& sha256) {
  JsonWriter json;
  json.begin_object().key("prediction");
  put_prediction(json, p);
  json.member("sha256", sha256).key("beside").begin_array(JsonWriter::Style::block);
  for (const ObservedMethod& observed : comparison.methods) {
    json.begin_object().member("method", p.methods[observed.method]).member("source", observed.source);
    put(json, "accuracy", accuracy(observed.table));
    put_counts(json, observed.table);
    json.key("fits").begin_array(JsonWriter::Style::block);
    for (std::size_t v = 0; v < p.variants.size(); ++v) {
      if (!p.variants[v].methods.empty()) put_fit(json, p.variants[v].name, observed.variants[v]);
    }
    for (std::size_t n = 0; n < p.nulls.size(); ++n)
      put_fit(json, "null: " + p.nulls[n].name, observed.nulls[n]);
    put_fit(json, "chance", observed.chance);
    put_fit(json, "the table itself", observed.itself);
    json.end_array();
    put(json, "ceiling_rms", observed.ceiling_rms);
    put(json, "ceiling_r", observed.ceiling_r);
    json.end_object();
  }
  json.end_array().key("left_out").begin_array(JsonWriter::Style::block);
  for (const std::string& line : comparison.left_out)
    json.value(line);
  json.end_array().end_object();
  return json.take();
}

}  // namespace palpa::observer
