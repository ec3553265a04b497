#include "study/report/measures_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>

#include "base/text.hpp"
#include "study/pages/numbers.hpp"
#include "study/report/figures.hpp"

namespace palpa::study {

std::string measures_text(const Measures& measures) {
  const Confusion& table = measures.table;
  constexpr std::size_t most_column = 12;
  std::size_t name = 6;
  std::string text;
  const auto out = std::back_inserter(text);
  for (const std::string& shape : table.shapes)
    name = std::max(name, std::min(printable(shape).size(), std::size_t{24}));
  fmt::format_to(out, "  {:<{}}", "actual", name);
  for (const std::string& shape : table.shapes)
    fmt::format_to(out, " {:>{}}", shortened(printable(shape), most_column), most_column);
  text += '\n';
  for (std::size_t i = 0; i < table.size(); ++i) {
    fmt::format_to(out, "  {:<{}}", shortened(printable(table.shapes[i]), 24), name);
    for (std::size_t j = 0; j < table.size(); ++j)
      fmt::format_to(out, " {:>{}}", shown(share(table, i, j)), most_column);
    text += '\n';
  }
  fmt::format_to(out, "  {} of {} correct: {}, d' {}, {} of {} bit\n", table.correct(), table.total(),
                 shown(measures.accuracy), shown(measures.dprime), shown(measures.information.bits),
                 shown(measures.information.most_bits));
  return text;
}

void add_measures(HtmlPage& page, const Measures& measures) {
  const Confusion& table = measures.table;
  page.figure(confusion_figure(measures),
              fmt::format("{}: shares of the answers (columns) for each actual shape (rows). {} of {} {} correct.",
                          measures.name, table.correct(), counted(table.total(), "trial"),
                          table.correct() == 1 ? "is" : "are"));
  std::vector<HtmlRow> rows{{"shape", "trials", "recall", "precision", "bias"}};
  for (std::size_t i = 0; i < table.size(); ++i) {
    rows.push_back({table.shapes[i], std::to_string(table.row(i)), shown(recall(table, i)), shown(precision(table, i)),
                    measures.luce_fit ? shown(measures.luce_fit->model.bias[i]) : no_value});
  }
  page.table(
      "Recall is the share of a shape's trials that were answered correctly, precision the share of its answers "
      "that were correct. Bias is Luce's: the preference for an answer, whatever was shown.",
      rows);
  rows = {{"pair", "d'", "similarity"}};
  for (const PairDistance& pair : measures.pairs) {
    const std::size_t cell = pair.a * table.size() + pair.b;
    rows.push_back({fmt::format("{}, {}", table.shapes[pair.a], table.shapes[pair.b]), shown(pair.dprime),
                    measures.luce_fit ? shown(measures.luce_fit->model.similarity[cell]) : no_value});
  }
  page.table(
      "How different two shapes feel. d' counts in standard deviations of the sensation's noise; 0 means that "
      "they cannot be told apart. Luce's similarity is 1 for shapes that feel the same and 0 for shapes that are "
      "never confused. Bias and similarity are those of the fit, which some tables do not have.",
      rows);
  rows = {{"measure", "value"},
          {"accuracy", shown(measures.accuracy)},
          {"95 % interval (Clopper-Pearson)", shown(std::optional(measures.clopper_pearson))},
          {"p of at least as many correct answers by chance", shown_p(measures.p_chance)},
          {"d' of all shapes", shown(measures.dprime)},
          {"transmitted information",
           fmt::format("{} of {} bit", shown(measures.information.bits), shown(measures.information.most_bits))},
          {"corrected for the number of trials", fmt::format("{} bit", shown(measures.information.corrected_bits))}};
  if (const auto& fit = measures.luce_fit) {
    rows.push_back({"fit of Luce's model", fmt::format("G2 = {} with {} of freedom, {}", shown(fit->deviance),
                                                       counted(fit->degrees, "degree"), shown_p(fit->p))});
  }
  page.table(
      "The interval and the tests of a table assume that all trials are independent. Trials of one participant are "
      "not, so they describe the table and do not replace the tests over participants.",
      rows);
}

void add_difference(HtmlPage& page, const std::string& a, const std::string& b, const std::vector<std::string>& shapes,
                    const TwoTables& tables) {
  std::vector<HtmlRow> rows{{"actual shape", "chi-square", "G2", "degrees of freedom", "p"}};
  const auto add_row = [&](const std::string& name, const Difference& row) {
    rows.push_back({name, shown(row.chi_square), shown(row.likelihood_ratio), fmt::format("{}", row.degrees),
                    fmt::format("{:.3g}", row.p)});
  };
  for (std::size_t i = 0; i < shapes.size(); ++i)
    add_row(shapes[i], tables.rows[i]);
  add_row("all", tables.all);
  page.table(
      fmt::format("{} beside {}: root mean square difference of the shares {}; correlation of the errors {}. The "
                  "tests assume that all trials are independent.",
                  a, b, shown(tables.rms), shown(tables.errors)),
      rows);
}

}  // namespace palpa::study
