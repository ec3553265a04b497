// The decisions of an ideal observer with one internal noise.
//
// A touch of a shape at a placement is felt as its template plus noise of the standard deviation sigma, the same in all
// directions. The observer knows all templates and sigma, but not the placement. It answers the shape with the largest
// likelihood, averaged over placements; no shape is preferred. The placement of the touch itself is left out, for all
// shapes, so that the observer never knows a touch in advance.
//
//   likelihood of a template t for a felt x = t0 + sigma n:  exp(-|t0 - t|^2 / (2 sigma^2) + n.t / sigma) times a
//   factor that all templates share
//
// Only the products n.t matter: they are normally distributed with the templates' scalar products as covariance. They
// are drawn at random, each with its mirror image. The draws are the same for every sigma and every shape, and
// independent for each placement.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "study/observer/templates.hpp"

namespace palpa::study {

/// Independent parts of the draws: their scatter tells the numerical error.
inline constexpr std::size_t noise_parts = 8;

struct Decisions {
  std::vector<double> shares;  ///< by rows: of the answers to each shape
  double accuracy = 0;
  std::array<double, noise_parts> by_part{};  ///< the accuracy of each part
};

class Observer {
 public:
  /// `templates` must outlive it. `points`: pairs of draws in each part, divided among the placements.
  explicit Observer(const Templates& templates, std::size_t points = 4096);

  /// From the first `parts` of the draws; `by_part` of the others is 0.
  Decisions decide(double sigma, std::size_t parts = noise_parts) const;

 private:
  const Templates& templates_;
  std::size_t points_;
  std::vector<float> noise_;  // [placement][draw][template]: n.t
};

/// The sigma with which the observer's accuracy is `accuracy`; 0 if it is lower even almost without noise.
double sigma_for(const Observer& observer, const Templates& templates, double accuracy);

}  // namespace palpa::study
