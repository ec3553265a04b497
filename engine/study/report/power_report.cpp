#include "study/report/reports.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <vector>

#include "base/files/json_writer.hpp"
#include "base/text.hpp"
#include "study/pages/html.hpp"
#include "study/pages/measures_json.hpp"
#include "study/pages/numbers.hpp"
#include "study/report/figures.hpp"

namespace palpa::study {
namespace {

std::string setting_line(const PowerSetting& s) {
  return fmt::format(
      "accuracies {} and {}, {} each, spread {} between participants, correlation {}; test at {}; {}, seed {}", s.a,
      s.b, counted(s.trials, "trial"), s.spread, s.correlation, s.alpha, counted(s.studies, "study"), s.seed);
}

std::string answer_line(const PowerSetting& setting, const PowerResult& result) {
  if (!result.people) {
    return fmt::format("{} {} not reach a power of {}", counted(setting.most_people, "participant"),
                       setting.most_people == 1 ? "does" : "do", setting.power);
  }
  return fmt::format("{} {} a power of {}", counted(*result.people, "participant"),
                     *result.people == 1 ? "reaches" : "reach", setting.power);
}

std::string other_line(const PowerSetting& setting, const OtherCorrelation& other) {
  return fmt::format("with a correlation of {}: {}", other.correlation,
                     other.people ? counted(*other.people, "participant")
                                  : fmt::format("more than {} participants", setting.most_people));
}

constexpr const char* why_others =
    "The correlation is that of ten people, whose accuracies have the chance of their trials in them. Its 95 % "
    "interval "
    "is 0.27 to 0.94. At its ends:";

}  // namespace

std::string power_text(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others) {
  std::string text = setting_line(setting) + "\n\n  participants   power   95 %\n";
  for (const PowerRow& row : result.rows) {
    fmt::format_to(std::back_inserter(text), "  {:>12}   {}   {}\n", row.people, shown(row.power),
                   shown(std::optional(row.interval)));
  }
  text += fmt::format("\n{}\n", answer_line(setting, result));
  if (!others.empty()) text += fmt::format("{}\n", why_others);
  for (const OtherCorrelation& other : others)
    text += fmt::format("  {}\n", other_line(setting, other));
  return text;
}

std::string power_json(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others) {
  JsonWriter json;
  json.begin_object().key("accuracies").begin_array().value(setting.a).value(setting.b).end_array();
  json.member("spread", setting.spread).member("correlation", setting.correlation).member("trials", setting.trials);
  json.member("alpha", setting.alpha).member("power", setting.power).member("studies", setting.studies);
  json.member("seed", setting.seed).member("participants", result.people);
  json.key("other_correlations").begin_array(JsonWriter::Style::block);
  for (const OtherCorrelation& other : others) {
    json.begin_object(JsonWriter::Style::line).member("correlation", other.correlation);
    json.member("participants", other.people).end_object();
  }
  json.end_array().key("rows").begin_array(JsonWriter::Style::block);
  for (const PowerRow& row : result.rows) {
    json.begin_object(JsonWriter::Style::line).member("participants", row.people).member("found", row.found);
    put(json, "power", row.power);
    put(json, "interval", std::optional(row.interval));
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::string power_csv(const PowerResult& result) {
  std::string csv = "participants,found,power,low,high\n";
  for (const PowerRow& row : result.rows) {
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{}\n", row.people, row.found, number_cell(row.power),
                   number_cell(row.interval.low), number_cell(row.interval.high));
  }
  return csv;
}

std::string power_html(const PowerSetting& setting, const PowerResult& result,
                       const std::vector<OtherCorrelation>& others) {
  HtmlPage page("How many participants?");
  page.paragraph(answer_line(setting, result) + ".");
  page.paragraph("Simulated: " + setting_line(setting) + ".");
  if (!others.empty()) {
    page.paragraph(why_others);
    std::vector<std::string> lines;
    lines.reserve(others.size());
    for (const OtherCorrelation& other : others)
      lines.push_back(other_line(setting, other));
    page.list(lines);
  }
  page.figure(
      power_figure(setting, result),
      "The share of simulated studies in which Wilcoxon's exact signed-rank test finds the difference, with its "
      "95 % interval.");
  std::vector<HtmlRow> rows{{"participants", "power", "95 %"}};
  for (const PowerRow& row : result.rows)
    rows.push_back({std::to_string(row.people), shown(row.power), shown(std::optional(row.interval))});
  page.table("Power by number of participants.", rows);
  return page.finish();
}

}  // namespace palpa::study
