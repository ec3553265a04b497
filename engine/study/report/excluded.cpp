#include "study/report/excluded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/text.hpp"
#include "study/pages/numbers.hpp"

namespace palpa::study {
namespace {

std::uint64_t trials_of(const Analysis& analysis, std::size_t person, std::size_t method) {
  const auto is = [&](const PersonResult& result) { return result.person == person && result.method == method; };
  const auto found = std::ranges::find_if(analysis.results.people, is);
  return found == analysis.results.people.end() ? 0 : found->table.total();
}

}  // namespace

std::string void_text(const Analysis& analysis, const MethodResult& method) {
  std::string text;
  for (std::size_t shape = 0; shape < method.void_shapes.size(); ++shape) {
    if (method.void_shapes[shape] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", printable(analysis.study.shapes[shape]),
                        method.void_shapes[shape]);
  }
  return text;
}

std::vector<std::string> excluded_lines(const Analysis& analysis, const MethodPair& pair) {
  if (pair.excluded.empty()) return {};
  std::vector<std::string> people;
  people.reserve(pair.excluded.size());
  for (const std::size_t person : pair.excluded) {
    people.push_back(fmt::format("participant {} ({} and {})", analysis.study.participants[person].number,
                                 trials_of(analysis, person, pair.a), trials_of(analysis, person, pair.b)));
  }
  std::vector<std::string> lines{fmt::format("left out, because the plan asks for at least {} with each method: {}",
                                             counted(analysis.study.least_trials, "trial"), fmt::join(people, ", "))};
  if (pair.with_excluded) {
    lines.push_back(fmt::format("with them: mean {} of {}, Wilcoxon's test {}", shown(pair.mean_with_excluded),
                                counted(pair.people_with_excluded, "participant"),
                                shown_p(pair.with_excluded->two_sided)));
  }
  return lines;
}

}  // namespace palpa::study
