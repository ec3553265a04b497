// The whole analysis of a study: read it (files/study_folder.hpp), analyse it, write reports of it (report/).
#pragma once

#include <cstdint>
#include <vector>

#include "study/between_methods.hpp"
#include "study/by_method.hpp"
#include "study/course.hpp"
#include "study/files/trial.hpp"

namespace palpa::study {

struct Analysis {
  Study study{};
  std::uint64_t seed = 0;  ///< of the bootstrap
  Results results{};
  BetweenMethods between{};
  std::vector<MethodCourse> courses{};
};
/// The study must have trials, as read_study() makes sure. The same study and seed give the same numbers.
Analysis analyse(Study study, std::uint64_t seed);

}  // namespace palpa::study
