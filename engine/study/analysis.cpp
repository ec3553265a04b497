#include "study/analysis.hpp"

#include <utility>

namespace palpa::study {

Analysis analyse(Study study, std::uint64_t seed) {
  Analysis analysis{.study = std::move(study), .seed = seed};
  analysis.results = results_by_method(analysis.study, seed);
  analysis.between = between_methods(analysis.study, analysis.results, seed);
  analysis.courses = courses(analysis.study);
  return analysis;
}

}  // namespace palpa::study
