#include "study/pages/measures_json.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace palpa::study {
namespace {

constexpr int digits = 10;

void put_square(JsonWriter& json, std::string_view key, const std::vector<double>& values, std::size_t m) {
  json.key(key).begin_array();
  for (std::size_t i = 0; i < m; ++i) {
    json.begin_array();
    for (std::size_t j = 0; j < m; ++j)
      json.rounded(values[i * m + j], digits);
    json.end_array();
  }
  json.end_array();
}

void put_difference(JsonWriter& json, const Difference& difference) {
  put(json, "chi_square", difference.chi_square);
  put(json, "likelihood_ratio", difference.likelihood_ratio);
  put(json, "degrees", difference.degrees);
  put(json, "p", difference.p);
  put(json, "p_likelihood_ratio", difference.p_likelihood_ratio);
}

}  // namespace

void put(JsonWriter& json, std::string_view key, double value) {
  json.key(key).rounded(value, digits);
}

void put(JsonWriter& json, std::string_view key, const std::optional<double>& value) {
  // A number that is not finite becomes null.
  put(json, key, value.value_or(std::numeric_limits<double>::infinity()));
}

void put(JsonWriter& json, std::string_view key, const std::optional<Interval>& interval) {
  json.key(key);
  if (!interval) {
    json.null();
    return;
  }
  json.begin_array().rounded(interval->low, digits).rounded(interval->high, digits).end_array();
}

void put(JsonWriter& json, std::string_view key, const std::optional<Correlation>& correlation) {
  json.key(key);
  if (!correlation) {
    json.null();
    return;
  }
  json.begin_object(JsonWriter::Style::line);
  put(json, "r", correlation->r);
  put(json, "p", correlation->p);
  put(json, "interval", correlation->interval);
  json.end_object();
}

void put(JsonWriter& json, std::string_view key, const std::vector<double>& values) {
  json.key(key).begin_array();
  for (const double value : values)
    json.rounded(value, digits);
  json.end_array();
}

void put(JsonWriter& json, std::string_view key, const SignedRank& test) {
  json.key(key).begin_object(JsonWriter::Style::line);
  json.member("pairs", std::uint64_t{test.pairs}).member("nonzero", std::uint64_t{test.nonzero});
  put(json, "positive", test.positive);
  put(json, "negative", test.negative);
  json.member("exact", test.exact);
  put(json, "p_two_sided", test.two_sided);
  put(json, "p_greater", test.greater);
  put(json, "p_less", test.less);
  put(json, "p_normal", test.normal);
  put(json, "p_normal_corrected", test.normal_corrected);
  json.end_object();
}

void put(JsonWriter& json, std::string_view key, const TwoTables& tables) {
  json.key(key).begin_object();
  put(json, "rms", tables.rms);
  put(json, "errors", tables.errors);
  put_difference(json, tables.all);
  json.key("rows").begin_array();
  for (const Difference& row : tables.rows) {
    json.begin_object(JsonWriter::Style::line);
    put_difference(json, row);
    json.end_object();
  }
  json.end_array();
  json.key("correct").begin_object(JsonWriter::Style::line);
  put(json, "chi_square", tables.correct.chi_square);
  put(json, "p", tables.correct.p);
  json.end_object().end_object();
}

void put_counts(JsonWriter& json, const Confusion& table) {
  json.key("counts").begin_array();
  for (std::size_t i = 0; i < table.size(); ++i) {
    json.begin_array();
    for (std::size_t j = 0; j < table.size(); ++j)
      json.value(table.at(i, j));
    json.end_array();
  }
  json.end_array();
}

void put_measures(JsonWriter& json, const Measures& measures) {
  const Confusion& table = measures.table;
  json.member("trials", table.total()).member("correct", table.correct());
  put_counts(json, table);
  put(json, "accuracy", measures.accuracy);
  put(json, "clopper_pearson", std::optional(measures.clopper_pearson));
  put(json, "p_chance", measures.p_chance);
  json.key("recall").begin_array();
  for (std::size_t i = 0; i < table.size(); ++i)
    json.rounded(recall(table, i).value_or(std::numeric_limits<double>::infinity()), digits);
  json.end_array().key("precision").begin_array();
  for (std::size_t i = 0; i < table.size(); ++i)
    json.rounded(precision(table, i).value_or(std::numeric_limits<double>::infinity()), digits);
  json.end_array();
  put(json, "dprime", measures.dprime);
  json.key("dprime_pairs").begin_array();
  for (const PairDistance& pair : measures.pairs) {
    json.begin_object(JsonWriter::Style::line).member("a", table.shapes[pair.a]).member("b", table.shapes[pair.b]);
    put(json, "dprime", pair.dprime);
    json.end_object();
  }
  json.end_array().key("luce_fit");
  if (const auto& fit = measures.luce_fit) {
    json.begin_object();
    put_square(json, "similarity", fit->model.similarity, table.size());
    put(json, "bias", fit->model.bias);
    put(json, "deviance", fit->deviance);
    put(json, "degrees", fit->degrees);
    put(json, "p", fit->p);
    put(json, "negative_log_likelihood", fit->negative_log_likelihood);
    json.end_object();
  } else {
    json.null();
  }
  json.key("information").begin_object(JsonWriter::Style::line);
  put(json, "bits", measures.information.bits);
  put(json, "corrected_bits", measures.information.corrected_bits);
  put(json, "most_bits", measures.information.most_bits);
  put(json, "chi_square", measures.information.chi_square);
  json.end_object();
}

}  // namespace palpa::study
