#include "study/by_method.hpp"

#include <utility>

#include "study/statistics/paired.hpp"
#include "study/tables/dprime.hpp"

namespace palpa::study {
namespace {

/// One participant's results, in the order of the methods.
std::vector<PersonResult> results_of(const Study& study, std::size_t person) {
  std::vector<PersonResult> all(study.methods.size());
  std::vector<std::vector<double>> times(study.methods.size());
  std::uint32_t turns = 0;
  for (const Trial& trial : study.participants[person].trials) {
    PersonResult& result = all[trial.method];
    if (result.turn == 0) {
      result = {.person = person, .method = trial.method, .turn = ++turns, .table = Confusion(study.shapes)};
    }
    ++result.table.at(trial.shape, trial.answer);
    if (trial.response_s) times[trial.method].push_back(*trial.response_s);
  }
  std::erase_if(all, [](const PersonResult& result) { return result.turn == 0; });
  const std::vector<std::uint32_t>& voids = study.participants[person].voids;
  for (PersonResult& result : all) {
    if (result.method < voids.size()) result.voids = voids[result.method];
    result.accuracy = accuracy(result.table);
    result.dprime =
        dprime(result.table.correct(), result.table.total(), static_cast<std::uint32_t>(result.table.size()));
    result.bits = information(result.table).bits;
    if (!times[result.method].empty()) result.response_s = median(std::move(times[result.method]));
  }
  return all;
}

}  // namespace

Results results_by_method(const Study& study, std::uint64_t seed) {
  Results results;
  for (std::size_t person = 0; person < study.participants.size(); ++person) {
    for (PersonResult& result : results_of(study, person))
      results.people.push_back(std::move(result));
  }
  for (std::size_t m = 0; m < study.methods.size(); ++m) {
    MethodResult& method = results.methods.emplace_back();
    Confusion pooled(study.shapes);
    for (std::size_t i = 0; i < results.people.size(); ++i) {
      if (results.people[i].method != m) continue;
      add(pooled, results.people[i].table);
      method.results.push_back(i);
      method.accuracies.push_back(results.people[i].accuracy);
    }
    method.void_shapes.resize(study.shapes.size(), 0);
    for (const Participant& participant : study.participants) {
      method.voids += m < participant.voids.size() ? participant.voids[m] : 0;
      for (std::size_t s = 0; s < study.shapes.size() && !participant.void_shapes.empty(); ++s)
        method.void_shapes[s] += participant.void_shapes[m * study.shapes.size() + s];
    }
    method.pooled = measure(study.methods[m], pooled);
    method.mean_accuracy = mean(method.accuracies);
    method.deviation = standard_deviation(method.accuracies);
    method.t = t_interval(method.accuracies);
    method.bootstrap = bootstrap_mean(method.accuracies, seed, bootstrap_resamples(method.accuracies.size()));
  }
  return results;
}

}  // namespace palpa::study
