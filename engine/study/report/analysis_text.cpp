#include <fmt/format.h>

#include <iterator>

#include "base/text.hpp"
#include "study/report/analysis_reports.hpp"
#include "study/report/measures_text.hpp"
#include "study/report/numbers.hpp"

namespace palpa::study {

std::string analysis_text(const Analysis& analysis) {
  const Study& study = analysis.study;
  std::string text = fmt::format("{} participant{}, {} shapes, {} method{}\n", study.participants.size(),
                                 study.participants.size() == 1 ? "" : "s", study.shapes.size(), study.methods.size(),
                                 study.methods.size() == 1 ? "" : "s");
  const auto out = std::back_inserter(text);
  for (const MethodResult& method : analysis.results.methods) {
    fmt::format_to(out, "\n{}: mean accuracy {} of {} participant{}, SD {}, 95 % {}\n", printable(method.pooled.name),
                   shown(method.mean_accuracy), method.accuracies.size(), method.accuracies.size() == 1 ? "" : "s",
                   shown(method.deviation), shown(method.t));
    text += measures_text(method.pooled);
  }
  for (const MethodPair& pair : analysis.between.pairs) {
    fmt::format_to(out, "\n{} minus {}: mean {} (95 % {}) of {} participant{}\n", printable(study.methods[pair.b]),
                   printable(study.methods[pair.a]), shown(pair.mean), shown(pair.t), pair.people.size(),
                   pair.people.size() == 1 ? "" : "s");
    fmt::format_to(out, "  Wilcoxon's signed-rank test, {}: {}, T+ = {}\n", pair.drop.exact ? "exact" : "approximate",
                   shown_p(pair.drop.two_sided), pair.drop.positive);
    if (pair.holm) fmt::format_to(out, "  after Holm's correction for all pairs: {}\n", shown_p(*pair.holm));
    fmt::format_to(out, "  correlation of the participants' accuracies: {}\n", shown(pair.pearson));
  }
  if (const auto& friedman = analysis.between.friedman) {
    fmt::format_to(out, "\nFriedman's test of all methods: chi-square {} with {} degrees of freedom, {}\n",
                   shown(friedman->chi_square), friedman->degrees, shown_p(friedman->p));
  }
  if (!study.left_out.empty())
    fmt::format_to(out, "\n{} warning{} about files or rows, see above\n", study.left_out.size(),
                   study.left_out.size() == 1 ? "" : "s");
  return text;
}

}  // namespace palpa::study
