#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "study/pages/html.hpp"
#include "study/pages/numbers.hpp"
#include "study/report/excluded.hpp"
#include "study/report/figures.hpp"
#include "study/report/measures_text.hpp"
#include "study/report/reports.hpp"
#include "study/statistics/paired.hpp"

namespace palpa::study {
namespace {

void add_overview(HtmlPage& page, const Analysis& analysis) {
  page.figure(accuracy_figure(analysis),
              "Accuracy of each participant with each method. The last group has the means; its bars show the standard "
              "deviation between participants.");
  std::vector<HtmlRow> rows{
      {"method", "participants", "mean accuracy", "SD", "95 % (t)", "95 % (bootstrap)", "void trials"}};
  for (const MethodResult& method : analysis.results.methods) {
    rows.push_back({method.pooled.name, std::to_string(method.accuracies.size()), shown(method.mean_accuracy),
                    shown(method.deviation), shown(method.t), shown(method.bootstrap), std::to_string(method.voids)});
  }
  page.table(fmt::format("The mean over participants and its 95 % intervals: Student's t, and a bootstrap over "
                         "participants ({} resamples, seed {}).",
                         bootstrap_resamples(analysis.study.participants.size()), analysis.seed),
             rows);
  std::vector<std::string> voids;
  for (const MethodResult& method : analysis.results.methods) {
    if (const std::string shapes = void_text(analysis, method); !shapes.empty())
      voids.push_back(fmt::format("{}: void trials by shape, which is not chance: {}", method.pooled.name, shapes));
  }
  if (!voids.empty()) page.list(voids);
}

void add_pair(HtmlPage& page, const Analysis& analysis, const MethodPair& pair) {
  const std::string &a = analysis.study.methods[pair.a], &b = analysis.study.methods[pair.b];
  page.heading(fmt::format("{} minus {}", b, a));
  if (!pair.excluded.empty()) page.list(excluded_lines(analysis, pair));
  if (pair.people.empty()) {
    page.paragraph("Nobody has enough trials with both methods, so they are not compared.");
    return;
  }
  std::vector<HtmlRow> rows{
      {"measure", "value"},
      {"participants with both methods", std::to_string(pair.people.size())},
      {"mean difference of accuracy", shown(pair.mean)},
      {"95 % (t)", shown(pair.t)},
      {"95 % (bootstrap)", shown(pair.bootstrap)},
      {"Hodges-Lehmann estimate", shown(pair.hodges_lehmann.estimate)},
      {"at least 95 % (Walsh averages)", shown(pair.hodges_lehmann.interval)},
      {"Cohen's d of the differences", shown(pair.cohens_d)},
      {fmt::format("Wilcoxon's signed-rank test, {}", pair.drop.exact ? "exact" : "normal approximation"),
       fmt::format("T+ = {}, T- = {}, {}", pair.drop.positive, pair.drop.negative, shown_p(pair.drop.two_sided))},
      {"the same with Pratt's treatment of zeros", shown_p(pair.pratt.two_sided)}};
  if (pair.holm) rows.push_back({"after Holm's correction for all pairs", shown_p(*pair.holm)});
  rows.push_back({"correlation of the accuracies (Pearson)", shown(pair.pearson)});
  rows.push_back({"correlation of their ranks (Spearman)", shown(pair.spearman)});
  if (pair.order.test) {
    rows.push_back({fmt::format("mean difference of the {} who had {} before {}", pair.order.a_first.size(), a, b),
                    shown(mean(pair.order.a_first))});
    rows.push_back({fmt::format("mean difference of the {} who had {} before {}", pair.order.b_first.size(), b, a),
                    shown(mean(pair.order.b_first))});
    rows.push_back({"effect of the order (rank-sum test)", shown_p(pair.order.test->p)});
  }
  page.table("All tests are two-sided and over participants.", rows);
  add_difference(page, a, b, analysis.study.shapes, pair.tables);
}

void add_courses(HtmlPage& page, const Analysis& analysis) {
  page.heading("Over the trials");
  page.figure(learning_figure(analysis), "Mean accuracy in each quarter of the trials with a method.");
  std::vector<HtmlRow> rows{
      {"method", "mean gain of the second half", "Wilcoxon", "answer time (s)", "if correct (s)", "if wrong (s)"}};
  for (std::size_t m = 0; m < analysis.courses.size(); ++m) {
    const MethodCourse& course = analysis.courses[m];
    const std::vector<double>& gains = course.learning.gains;
    rows.push_back({analysis.study.methods[m], gains.empty() ? no_value : shown(mean(gains)),
                    gains.empty() ? no_value : shown_p(course.learning.test.two_sided), shown(course.times.median_s),
                    shown(course.times.correct_s), shown(course.times.wrong_s)});
  }
  page.table("Times are medians over participants of each participant's median.", rows);
  for (std::size_t m = 0; m < analysis.courses.size(); ++m) {
    if (analysis.courses[m].depths.empty()) continue;
    page.figure(depth_figure(analysis, m),
                fmt::format("{}: mean depth of the finger below the top of the object, by time in the trial.",
                            analysis.study.methods[m]));
  }
}

void add_people(HtmlPage& page, const Analysis& analysis) {
  page.heading("Participants");
  std::vector<HtmlRow> rows{
      {"participant", "method", "turn", "trials", "void", "correct", "accuracy", "d'", "bit", "answer time (s)"}};
  for (const PersonResult& result : analysis.results.people) {
    rows.push_back({std::to_string(analysis.study.participants[result.person].number),
                    analysis.study.methods[result.method], std::to_string(result.turn),
                    std::to_string(result.table.total()), std::to_string(result.voids),
                    std::to_string(result.table.correct()), shown(result.accuracy), shown(result.dprime),
                    shown(result.bits), shown(result.response_s)});
  }
  page.table("Turn 1 is the method with which the participant began. The information of few trials is too large.",
             rows);
  std::vector<std::string> unfelt;
  for (const Participant& person : analysis.study.participants) {
    if (person.unfelt > 0)
      unfelt.push_back(fmt::format("participant {} felt nothing in {} of {}", person.number, person.unfelt,
                                   counted(person.asked, "familiarisation")));
  }
  if (!unfelt.empty()) page.list(unfelt);
}

}  // namespace

std::string analysis_html(const Analysis& analysis) {
  HtmlPage page("Which shape was it? Results of a study");
  page.paragraph(fmt::format("{} answered which of {} shapes they touched.",
                             counted(analysis.study.participants.size(), "participant"), analysis.study.shapes.size()));
  if (!analysis.study.left_out.empty()) {
    page.paragraph("Not everything could be analysed:");
    page.list(analysis.study.left_out);
  }
  page.heading("Accuracy");
  add_overview(page, analysis);
  if (const auto& friedman = analysis.between.friedman) {
    page.paragraph(fmt::format("Friedman's test of all methods over {}: chi-square {} with {} of freedom, {}.",
                               counted(friedman->people, "participant"), shown(friedman->chi_square),
                               counted(friedman->degrees, "degree"), shown_p(friedman->p)));
  }
  for (const MethodPair& pair : analysis.between.pairs)
    add_pair(page, analysis, pair);
  for (const MethodResult& method : analysis.results.methods) {
    page.heading(fmt::format("Answers with {}", method.pooled.name));
    add_measures(page, method.pooled);
  }
  add_courses(page, analysis);
  add_people(page, analysis);
  return page.finish();
}

}  // namespace palpa::study
