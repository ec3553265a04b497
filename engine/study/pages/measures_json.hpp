// Measures and tests as members of a JSON object. Numbers have ten digits, because the last ones of a double depend on
// the C library.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/files/json_writer.hpp"
#include "study/statistics/moments.hpp"
#include "study/statistics/wilcoxon.hpp"
#include "study/tables/measures.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::study {

void put(JsonWriter& json, std::string_view key, double value);
/// null without a value.
void put(JsonWriter& json, std::string_view key, const std::optional<double>& value);
/// [low, high].
void put(JsonWriter& json, std::string_view key, const std::optional<Interval>& interval);
void put(JsonWriter& json, std::string_view key, const std::optional<Correlation>& correlation);
void put(JsonWriter& json, std::string_view key, const std::vector<double>& values);
void put(JsonWriter& json, std::string_view key, const SignedRank& test);
void put(JsonWriter& json, std::string_view key, const TwoTables& tables);

/// The rows of a table: "counts": [[50, 30], [9, 11]].
void put_counts(JsonWriter& json, const Confusion& table);
/// All members of a table, except its name.
void put_measures(JsonWriter& json, const Measures& measures);

}  // namespace palpa::study
