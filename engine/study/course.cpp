#include "study/course.hpp"

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

}  // namespace

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

}  // namespace palpa::study
