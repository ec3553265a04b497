// The reports of studies, comparisons and simulations: complete, without anything from outside, and the same each time.
#include <gtest/gtest.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "study/comparison.hpp"
#include "study/files/results_file.hpp"
#include "study/files/study_folder.hpp"
#include "study/pages/html.hpp"
#include "study/pages/svg.hpp"
#include "study/report/reports.hpp"
#include "study/tables/paper.hpp"
#include "support/occurrences.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

using nlohmann::json;
using test::occurrences;

/// The first row of every table, and the first cell of every other row, are heads, and nothing else is.
void expect_heads(const std::string& html) {
  for (std::size_t at = html.find("<tr>"); at != std::string::npos; at = html.find("<tr>", at + 1)) {
    const std::string row = html.substr(at + 4, html.find("</tr>", at) - at - 4);
    const bool first = std::string_view(html).substr(0, at).ends_with("</caption>\n");
    EXPECT_TRUE(row.starts_with("<th>")) << row;
    EXPECT_EQ(occurrences(row, first ? "<td>" : "<th>"), first ? 0u : 1u) << row;
  }
}

/// Every element ends, nothing is loaded from elsewhere, and no number is missing.
void expect_page(const std::string& html) {
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(html.ends_with("</html>\n"));
  for (const std::string element : {"table", "figure", "svg", "tr", "th", "td", "text", "h2", "p", "ul", "rect"}) {
    EXPECT_EQ(occurrences(html, "<" + element + ">") + occurrences(html, "<" + element + " "),
              occurrences(html, "</" + element + ">"))
        << element;
  }
  expect_heads(html);
  for (const char* foreign : {"<script", "src=", "href=", "url(", "nan", "inf\""})
    EXPECT_EQ(html.find(foreign), std::string::npos) << foreign;
}

Analysis ten() {
  const auto folder = test::scratch_folder("reports");
  test::write_ten(folder);
  return analyse(read_study(std::vector<std::string>{folder.string()}), 0);
}

TEST(Reports, OfAStudy) {
  const Analysis analysis = ten();
  const std::string html = analysis_html(analysis), text = analysis_text(analysis), csv = analysis_csv(analysis);
  expect_page(html);
  EXPECT_CONTAINS(html, "p = 0.00195");
  EXPECT_CONTAINS(html, "seed 0");
  EXPECT_EQ(occurrences(html, "<svg"), 4u) << "accuracies, two confusion matrices, learning";
  EXPECT_CONTAINS(text, "single-focus: mean accuracy 0.390 of 10 participants");
  EXPECT_CONTAINS(text, "cross-section: mean accuracy 0.653 of 10 participants");
  EXPECT_CONTAINS(text, "exact: p = 0.00195, T+ = 55");
  EXPECT_EQ(occurrences(csv, "\n"), 21u);
  EXPECT_CONTAINS(csv, "1,single-focus,1,40,18,0.45,");
  EXPECT_EQ(analysis_html(ten()), html);
  EXPECT_EQ(analysis_json(ten()), analysis_json(analysis));
}

TEST(Reports, JsonHasTheNumbersAndIsReadBack) {
  const Analysis analysis = ten();
  const std::string text = analysis_json(analysis);
  const json document = json::parse(text);
  EXPECT_EQ(document["methods"][0]["mean_accuracy"], 0.39);
  EXPECT_EQ(document["methods"][1]["accuracy"], 0.6525);
  EXPECT_EQ(document["pairs"][0]["wilcoxon"]["p_two_sided"], 0.001953125);
  EXPECT_EQ(document["participants"].size(), 20u);
  EXPECT_TRUE(document["left_out"].empty());
  const auto file = test::scratch_folder("results") / "a.json";
  test::write_text(file, text);
  std::vector<std::string> left_out;
  const auto tables = read_results(file, left_out);
  EXPECT_TRUE(left_out.empty());
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[1].first, "cross-section");
  EXPECT_EQ(tables[1].second, analysis.results.methods[1].pooled.table);
  Analysis warned = analysis;
  warned.study.left_out = {"a.tsv: is a rehearsal"};
  test::write_text(file, analysis_json(warned));
  read_results(file, left_out);
  EXPECT_EQ(left_out, warned.study.left_out);
}

TEST(Reports, JsonOfTablesIsReadBack) {
  const auto file = test::scratch_folder("results") / "a.json";
  Confusion other({"cone", "cube"});
  other.at(0, 0) = other.at(1, 0) = 5;
  const std::vector<NamedTable> both{{"counts.csv", paper_cross_section()}, {"other.csv", other}};
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
    const std::string text = comparison_json(
        compare_tables({both.begin(), both.begin() + static_cast<std::ptrdiff_t>(count)}), {"a warning"});
    EXPECT_CONTAINS(text, count == 1 ? "\"kind\": \"palpa study analyse\"" : "\"kind\": \"palpa study compare\"");
    test::write_text(file, text);
    std::vector<std::string> left_out;
    const std::vector<NamedTable> tables = tables_of(file.string(), left_out);
    ASSERT_EQ(tables.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(tables[i].name, file.string() + ": " + both[i].name);
      EXPECT_EQ(tables[i].table, both[i].table);
    }
    EXPECT_EQ(left_out, std::vector<std::string>{"a warning"});
  }
  // As palpa once wrote it.
  test::write_text(file, R"({"tables": [{"name": "m", "shapes": ["a", "b"], "counts": [[1, 2], [3, 4]]}]})");
  std::vector<std::string> left_out;
  EXPECT_EQ(read_results(file, left_out).at(0).second.counts, (std::vector<std::uint64_t>{1, 2, 3, 4}));
}

TEST(Reports, OtherJsonIsRefused) {
  const auto file = test::scratch_folder("results") / "a.json";
  const auto refused = [&](const std::string& text, const std::string& told) {
    test::write_text(file, text);
    std::vector<std::string> left_out;
    EXPECT_REFUSED(read_results(file, left_out), told);
  };
  const std::string begin = R"({"kind": "palpa study analyse", "shapes": ["a", "b"], "methods": )";
  refused("{}", "\"kind\" is not that of such a file: a JSON file of palpa study analyse or compare is needed");
  refused("not json", "\"kind\"");
  refused(R"({"kind": "palpa study analyse"})", "\"shapes\" is not a list");
  refused(R"({"kind": "palpa study analyse", "shapes": ["a", "a"], "methods": []})", "a name twice");
  refused(begin + "3}", "\"methods\" is not a list");
  refused(begin + "[3]}", "without a \"name\"");
  refused(begin + R"([{"name": "m", "counts": [[1, 2]]}]})", "\"counts\" does not have 2 rows");
  refused(begin + R"([{"name": "m", "counts": [[1, 2], [3, -4]]}]})",
          "row 2 of \"counts\" has something that is not a count");
  refused(begin + R"([{"name": "m", "counts": [[1, 2], [3]]}]})", "row 2 of \"counts\" does not have 2 counts");
}

TEST(Reports, OfTables) {
  Confusion turned({"prism", "pyramid", "semi-sphere", "cube"});
  const Confusion paper = paper_cross_section();
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j)
      turned.at(3 - i, 3 - j) = paper.at(i, j);
  }
  Confusion other({"cone", "cube"});
  other.at(0, 0) = other.at(1, 0) = 5;
  const Comparison comparison = compare_tables({{"one", paper}, {"turned", turned}, {"other", other}});
  ASSERT_EQ(comparison.pairs.size(), 1u);
  EXPECT_EQ(comparison.pairs[0].tables.rms, 0) << "the order of shapes does not matter";
  EXPECT_EQ(comparison.not_compared.size(), 2u);
  expect_page(comparison_html(comparison, comparison.not_compared));
  const json document = json::parse(comparison_json(comparison, {}));
  EXPECT_EQ(document["tables"][0]["accuracy"], 0.6525);
  EXPECT_EQ(document["tables"][0]["luce_fit"]["deviance"], 25.30202174);
  EXPECT_EQ(occurrences(comparison_csv(comparison), "\n"), 4u);
  EXPECT_CONTAINS(comparison_text(comparison), "261 of 400 correct: 0.653, d' 1.327");
}

TEST(Reports, OfPower) {
  const PowerSetting setting{.studies = 100, .most_people = 10};
  const PowerResult result = find_power(setting);
  const std::vector<OtherCorrelation> others = at_other_correlations(setting);
  expect_page(power_html(setting, result, others));
  const json document = json::parse(power_json(setting, result, others));
  EXPECT_EQ(document["participants"], 6);
  EXPECT_EQ(document["other_correlations"][0]["correlation"], 0.27);
  EXPECT_CONTAINS(power_text(setting, result, others), "seed 0");
  EXPECT_CONTAINS(power_text(setting, result, others), "6 participants reach a power of 0.8");
  EXPECT_CONTAINS(power_text(setting, result, others), "with a correlation of 0.94: 6 participants");
}

TEST(Reports, NamesFromFilesAreOnlyText) {
  EXPECT_EQ(escaped("<script>\"&\n\x80"), "&lt;script&gt;&quot;&amp;\\n\\x80");
  HtmlPage page("<b>");
  page.paragraph("<i>");
  page.table("<u>", {{"<s>"}});
  page.list({"</ul>"});
  const std::string html = page.finish();
  for (const char* element : {"<b>", "<i>", "<u>", "<s>"})
    EXPECT_EQ(html.find(element), std::string::npos) << element;
  expect_page(html);
}

}  // namespace
}  // namespace palpa::study
