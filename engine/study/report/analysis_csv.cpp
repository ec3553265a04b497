#include <fmt/format.h>

#include <iterator>

#include "study/pages/numbers.hpp"
#include "study/report/reports.hpp"

namespace palpa::study {

std::string analysis_csv(const Analysis& analysis) {
  std::string csv = "participant,method,turn,trials,correct,accuracy,dprime,bits,answer_time_s,void\n";
  for (const PersonResult& result : analysis.results.people) {
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{},{}\n",
                   analysis.study.participants[result.person].number, name_cell(analysis.study.methods[result.method]),
                   result.turn, result.table.total(), result.table.correct(), number_cell(result.accuracy),
                   number_cell(result.dprime), number_cell(result.bits), number_cell(result.response_s), result.voids);
  }
  return csv;
}

}  // namespace palpa::study
