#include "study/between_methods.hpp"

#include <utility>

namespace palpa::study {
namespace {

/// The result of that participant with that method.
const PersonResult* result_of(const Results& results, std::size_t person, std::size_t method) {
  for (const std::size_t i : results.methods[method].results) {
    if (results.people[i].person == person) return &results.people[i];
  }
  return nullptr;
}

/// b - a, from whole numbers and divided once, so that equal differences are equal doubles.
double difference(const Confusion& a, const Confusion& b) {
  const auto a_all = static_cast<double>(a.total()), b_all = static_cast<double>(b.total());
  const auto a_correct = static_cast<double>(a.correct()), b_correct = static_cast<double>(b.correct());
  return (b_correct * a_all - a_correct * b_all) / (a_all * b_all);
}

bool has_enough(const Study& study, const PersonResult& result) {
  return result.table.total() >= study.least_trials;
}

std::optional<MethodPair> pair_of(const Study& study, const Results& results, std::size_t a, std::size_t b,
                                  std::uint64_t seed) {
  MethodPair pair{.a = a, .b = b};
  std::vector<double> of_a, of_b, of_all;
  for (std::size_t person = 0; person < study.participants.size(); ++person) {
    const PersonResult* one = result_of(results, person, a);
    const PersonResult* other = result_of(results, person, b);
    if (!one || !other) {
      if ((one || other) && study.least_trials > 0) pair.excluded.push_back(person);
      continue;
    }
    of_all.push_back(difference(one->table, other->table));
    if (!has_enough(study, *one) || !has_enough(study, *other)) {
      pair.excluded.push_back(person);
      continue;
    }
    pair.people.push_back(person);
    pair.differences.push_back(of_all.back());
    (one->turn < other->turn ? pair.order.a_first : pair.order.b_first).push_back(pair.differences.back());
    of_a.push_back(one->accuracy);
    of_b.push_back(other->accuracy);
  }
  if (of_all.empty()) return std::nullopt;
  if (of_all.size() > pair.people.size()) {
    pair.people_with_excluded = of_all.size();
    pair.with_excluded = wilcoxon(of_all, Zeros::drop);
    pair.mean_with_excluded = mean(of_all);
  }
  pair.tables = compare(results.methods[a].pooled.table, results.methods[b].pooled.table);
  if (pair.people.empty()) return pair;
  pair.mean = mean(pair.differences);
  pair.t = t_interval(pair.differences);
  pair.bootstrap = bootstrap_mean(pair.differences, seed, bootstrap_resamples(pair.differences.size()));
  pair.cohens_d = cohens_d(pair.differences);
  pair.hodges_lehmann = hodges_lehmann(pair.differences);
  pair.drop = wilcoxon(pair.differences, Zeros::drop);
  pair.pratt = wilcoxon(pair.differences, Zeros::pratt);
  pair.pearson = pearson(of_a, of_b);
  pair.spearman = spearman(of_a, of_b);
  if (!pair.order.a_first.empty() && !pair.order.b_first.empty())
    pair.order.test = rank_sum(pair.order.a_first, pair.order.b_first);
  return pair;
}

std::optional<Friedman> friedman_of(const Study& study, const Results& results) {
  std::vector<std::vector<double>> rows;
  for (std::size_t person = 0; person < study.participants.size(); ++person) {
    std::vector<double> row;
    for (std::size_t m = 0; m < study.methods.size(); ++m) {
      const PersonResult* result = result_of(results, person, m);
      if (result && has_enough(study, *result)) row.push_back(result->accuracy);
    }
    if (row.size() == study.methods.size()) rows.push_back(std::move(row));
  }
  if (rows.size() < 2) return std::nullopt;
  return friedman(rows);
}

}  // namespace

BetweenMethods between_methods(const Study& study, const Results& results, std::uint64_t seed) {
  BetweenMethods found;
  for (std::size_t a = 0; a < study.methods.size(); ++a) {
    for (std::size_t b = a + 1; b < study.methods.size(); ++b) {
      if (auto pair = pair_of(study, results, a, b, seed)) found.pairs.push_back(std::move(*pair));
    }
  }
  if (study.methods.size() <= 2) return found;
  found.friedman = friedman_of(study, results);
  std::vector<double> p;
  std::vector<MethodPair*> tested;
  for (MethodPair& pair : found.pairs) {
    if (pair.people.empty()) continue;
    p.push_back(pair.drop.two_sided);
    tested.push_back(&pair);
  }
  const std::vector<double> corrected = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i)
    tested[i]->holm = corrected[i];
  return found;
}

}  // namespace palpa::study
