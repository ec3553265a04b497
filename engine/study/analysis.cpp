#include "study/analysis.hpp"

#include <algorithm>
#include <utility>

namespace palpa::study {
namespace {

std::vector<const Trial*> trials_of(const Participant& participant, std::size_t method) {
  std::vector<const Trial*> trials;
  for (const Trial& trial : participant.trials) {
    if (trial.method == method) trials.push_back(&trial);
  }
  return trials;
}

/// Correct answers of the trials begin ... end - 1.
double hits(const std::vector<const Trial*>& trials, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i)
    sum += trials[i]->correct() ? 1 : 0;
  return sum;
}

Learning learning_of(const Study& study, std::size_t method) {
  Learning learning;
  std::vector<double> sums(blocks, 0);
  double people = 0;
  for (const Participant& participant : study.participants) {
    const std::vector<const Trial*> trials = trials_of(participant, method);
    const std::size_t n = trials.size();
    if (n < blocks) continue;
    ++people;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t begin = n * b / blocks, end = n * (b + 1) / blocks;
      sums[b] += hits(trials, begin, end) / static_cast<double>(end - begin);
    }
    // As a quotient of whole numbers: equal gains are equal doubles.
    const std::size_t middle = n / 2;
    const auto first = static_cast<double>(middle), second = static_cast<double>(n - middle);
    learning.gains.push_back((hits(trials, middle, n) * first - hits(trials, 0, middle) * second) / (first * second));
  }
  if (people == 0) return learning;
  for (const double sum : sums)
    learning.block_accuracy.push_back(sum / people);
  learning.test = wilcoxon(learning.gains);
  return learning;
}

std::optional<double> median_of(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  return median(std::move(values));
}

AnswerTimes times_of(const Study& study, std::size_t method) {
  AnswerTimes times;
  std::vector<double> of_correct, of_wrong;
  for (const Participant& participant : study.participants) {
    std::vector<double> all, correct, wrong;
    for (const Trial& trial : participant.trials) {
      if (trial.method != method || !trial.response_s) continue;
      all.push_back(*trial.response_s);
      (trial.correct() ? correct : wrong).push_back(*trial.response_s);
    }
    if (const auto time = median_of(std::move(all))) times.medians.push_back(*time);
    if (const auto time = median_of(std::move(correct))) of_correct.push_back(*time);
    if (const auto time = median_of(std::move(wrong))) of_wrong.push_back(*time);
  }
  times.median_s = median_of(times.medians);
  times.correct_s = median_of(std::move(of_correct));
  times.wrong_s = median_of(std::move(of_wrong));
  return times;
}

MeanDepth depth_of(const Study& study, std::size_t place) {
  MeanDepth result;
  std::vector<double> sums, people;
  for (const Participant& participant : study.participants) {
    if (participant.depths.empty() || participant.depths[place].empty()) continue;
    const DepthCourse& course = participant.depths[place];
    ++result.people;
    sums.resize(std::max(sums.size(), course.samples.size()), 0);
    people.resize(sums.size(), 0);
    for (std::size_t bin = 0; bin < course.samples.size(); ++bin) {
      if (course.samples[bin] == 0) continue;
      sums[bin] += course.sum_m[bin] / course.samples[bin];
      ++people[bin];
    }
  }
  for (std::size_t bin = 0; bin < sums.size(); ++bin) {
    std::optional<double>& depth = result.depth_m.emplace_back();
    if (people[bin] > 0) depth = sums[bin] / people[bin];
  }
  return result;
}

/// In the order of Study::methods.
std::vector<MethodCourse> courses(const Study& study) {
  const bool recorded = std::ranges::any_of(study.participants, [](const Participant& p) { return !p.depths.empty(); });
  std::vector<MethodCourse> all;
  for (std::size_t m = 0; m < study.methods.size(); ++m) {
    MethodCourse& course =
        all.emplace_back(MethodCourse{.learning = learning_of(study, m), .times = times_of(study, m)});
    for (std::size_t shape = 0; recorded && shape < study.shapes.size(); ++shape)
      course.depths.push_back(depth_of(study, m * study.shapes.size() + shape));
  }
  return all;
}

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

}  // namespace

Analysis analyse(Study study, std::uint64_t seed) {
  Analysis analysis{.study = std::move(study), .seed = seed};
  analysis.results = results_by_method(analysis.study, seed);
  analysis.between = between_methods(analysis.study, analysis.results, seed);
  analysis.courses = courses(analysis.study);
  return analysis;
}

}  // namespace palpa::study
