// Luce's similarity choice model: the share of answers j for shape i is beta_j eta_ij / sum over k of beta_k eta_ik.
// eta_ij = eta_ji is the similarity of two shapes (1 for the same), beta_j the bias towards an answer (their sum is 1).
#pragma once

#include <optional>
#include <vector>

#include "study/tables/confusion.hpp"

namespace palpa::study {

struct Luce {
  std::vector<double> similarity;  ///< eta, by rows, all shapes by all shapes
  std::vector<double> bias;        ///< beta
};

struct LuceFit {
  Luce model;
  double deviance = 0;  ///< G2: twice the logarithm of the likelihood ratio to the table itself
  double degrees = 0;   ///< (m - 1)(m - 2) / 2
  double p = 1;         ///< of a table that fits worse, if the model were true and all trials independent
  double negative_log_likelihood = 0;
};
/// The fit of largest likelihood. Similarities of shapes that were never confused are 0. Empty if a shape has no trials
/// or was never recognised, if some shapes are never confused with the others, and for fewer than 3 shapes, which the
/// model always fits.
std::optional<LuceFit> luce_fit(const Confusion& table);

}  // namespace palpa::study
