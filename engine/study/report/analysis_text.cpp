#include <fmt/format.h>

#include <iterator>

#include "base/text.hpp"
#include "study/pages/numbers.hpp"
#include "study/report/excluded.hpp"
#include "study/report/measures_text.hpp"
#include "study/report/reports.hpp"

namespace palpa::study {

namespace {

void add_excluded(std::string& text, const Analysis& analysis, const MethodPair& pair) {
  for (const std::string& line : excluded_lines(analysis, pair))
    text += fmt::format("  {}\n", line);
}

}  // namespace

std::string analysis_text(const Analysis& analysis) {
  const Study& study = analysis.study;
  std::string text = fmt::format("{}, {} shapes, {}\n", counted(study.participants.size(), "participant"),
                                 study.shapes.size(), counted(study.methods.size(), "method"));
  const auto out = std::back_inserter(text);
  for (const MethodResult& method : analysis.results.methods) {
    fmt::format_to(out, "\n{}: mean accuracy {} of {}, SD {}, 95 % {}; {} void\n", printable(method.pooled.name),
                   shown(method.mean_accuracy), counted(method.accuracies.size(), "participant"),
                   shown(method.deviation), shown(method.t), counted(method.voids, "trial"));
    if (const std::string voids = void_text(analysis, method); !voids.empty())
      fmt::format_to(out, "  void by shape, which is not chance: {}\n", voids);
    text += measures_text(method.pooled);
  }
  for (const MethodPair& pair : analysis.between.pairs) {
    if (pair.people.empty()) {
      fmt::format_to(out, "\n{} minus {}: nobody has enough trials\n", printable(study.methods[pair.b]),
                     printable(study.methods[pair.a]));
      add_excluded(text, analysis, pair);
      continue;
    }
    fmt::format_to(out, "\n{} minus {}: mean {} (95 % {}) of {}\n", printable(study.methods[pair.b]),
                   printable(study.methods[pair.a]), shown(pair.mean), shown(pair.t),
                   counted(pair.people.size(), "participant"));
    fmt::format_to(out, "  Wilcoxon's signed-rank test, {}: {}, T+ = {}\n", pair.drop.exact ? "exact" : "approximate",
                   shown_p(pair.drop.two_sided), pair.drop.positive);
    if (pair.holm) fmt::format_to(out, "  after Holm's correction for all pairs: {}\n", shown_p(*pair.holm));
    fmt::format_to(out, "  correlation of the participants' accuracies: {}\n", shown(pair.pearson));
    add_excluded(text, analysis, pair);
  }
  if (const auto& friedman = analysis.between.friedman) {
    fmt::format_to(out, "\nFriedman's test of all methods: chi-square {} with {} of freedom, {}\n",
                   shown(friedman->chi_square), counted(friedman->degrees, "degree"), shown_p(friedman->p));
  }
  for (const Participant& person : study.participants) {
    if (person.unfelt == 0) continue;
    fmt::format_to(out, "\nparticipant {} felt nothing in {} of {}\n", person.number, person.unfelt,
                   counted(person.asked, "familiarisation"));
  }
  if (!study.left_out.empty())
    fmt::format_to(out, "\n{} about files or rows, see above\n", counted(study.left_out.size(), "warning"));
  return text;
}

}  // namespace palpa::study
