#include "study/report/reports.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>

#include "base/files/json_writer.hpp"
#include "base/text.hpp"
#include "study/files/results_file.hpp"
#include "study/pages/html.hpp"
#include "study/pages/measures_json.hpp"
#include "study/pages/numbers.hpp"
#include "study/report/figures.hpp"
#include "study/report/measures_text.hpp"

namespace palpa::study {

std::string comparison_text(const Comparison& comparison) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const Measures& measures : comparison.tables) {
    if (!text.empty()) text += '\n';
    fmt::format_to(out, "{}: accuracy {}, 95 % {}\n", printable(measures.name), shown(measures.accuracy),
                   shown(std::optional(measures.clopper_pearson)));
    text += measures_text(measures);
  }
  for (const ComparedPair& pair : comparison.pairs) {
    fmt::format_to(
        out, "\n{} beside {}:\n  rms difference {}, correlation of the errors {}, G2 {} with {} of freedom\n",
        printable(comparison.tables[pair.b].name), printable(comparison.tables[pair.a].name), shown(pair.tables.rms),
        shown(pair.tables.errors), shown(pair.tables.all.likelihood_ratio), counted(pair.tables.all.degrees, "degree"));
  }
  return text;
}

std::string comparison_json(const Comparison& comparison, const std::vector<std::string>& left_out) {
  JsonWriter json;
  json.begin_object().member("kind", comparison.tables.size() == 1 ? results_kind : comparison_kind);
  json.member("version", 1).key("tables").begin_array(JsonWriter::Style::block);
  for (const Measures& measures : comparison.tables) {
    json.begin_object().member("name", measures.name).key("shapes").begin_array();
    for (const std::string& shape : measures.table.shapes)
      json.value(shape);
    json.end_array();
    put_measures(json, measures);
    json.end_object();
  }
  json.end_array().key("pairs").begin_array(JsonWriter::Style::block);
  for (const ComparedPair& pair : comparison.pairs) {
    json.begin_object().member("a", comparison.tables[pair.a].name).member("b", comparison.tables[pair.b].name);
    put(json, "tables", pair.tables);
    json.end_object();
  }
  json.end_array().key("left_out").begin_array(JsonWriter::Style::block);
  for (const std::string& line : left_out)
    json.value(line);
  json.end_array().end_object();
  return json.take();
}

std::string comparison_csv(const Comparison& comparison) {
  std::string csv = "name,trials,correct,accuracy,low,high,dprime,bits\n";
  for (const Measures& m : comparison.tables) {
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{}\n", name_cell(m.name), m.table.total(),
                   m.table.correct(), number_cell(m.accuracy), number_cell(m.clopper_pearson.low),
                   number_cell(m.clopper_pearson.high), number_cell(m.dprime), number_cell(m.information.bits));
  }
  return csv;
}

std::string comparison_html(const Comparison& comparison, const std::vector<std::string>& left_out) {
  HtmlPage page("Which shape was it? Results beside each other");
  if (!left_out.empty()) {
    page.paragraph("Not everything could be analysed:");
    page.list(left_out);
  }
  page.figure(
      comparison_figure(comparison.tables),
      "Accuracies with 95 % intervals (Clopper-Pearson). The intervals assume that all trials are independent.");
  for (const Measures& measures : comparison.tables) {
    page.heading(measures.name);
    add_measures(page, measures);
  }
  if (!comparison.pairs.empty()) page.heading("Differences");
  for (const ComparedPair& pair : comparison.pairs) {
    add_difference(page, comparison.tables[pair.a].name, comparison.tables[pair.b].name,
                   comparison.tables[pair.a].table.shapes, pair.tables);
  }
  return page.finish();
}

}  // namespace palpa::study
