// How much two confusion matrices of the same shapes differ.
//
// The tests assume that all trials are independent. Trials of one person are not, so these values only describe a
// difference. Whether people differ is tested over people (study/analysis.hpp).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "study/statistics/moments.hpp"
#include "study/tables/confusion.hpp"

namespace palpa::study {

struct Difference {
  double chi_square = 0;
  double likelihood_ratio = 0;  ///< G2
  double degrees = 0;
  double p = 1;  ///< of chi_square
  double p_likelihood_ratio = 1;
};

struct TwoTables {
  std::vector<Difference> rows;       ///< for each actual shape, the answers in both tables
  Difference all;                     ///< their sum
  Difference correct;                 ///< correct and wrong answers; likelihood_ratio is not computed
  double rms = 0;                     ///< root mean square difference of the shares
  std::optional<Correlation> errors;  ///< of the shares off the diagonal
};
/// Both must have the same shapes. Shares of shapes without trials count as 0.
TwoTables compare(const Confusion& a, const Confusion& b);

/// The shares of a table, by rows; 0 for shapes without trials.
std::vector<double> shares_of(const Confusion& table);
/// Root mean square difference of the shares of two tables of the same size.
double rms_difference(std::span<const double> a, std::span<const double> b);
/// The correlation of their shares off the diagonal.
std::optional<Correlation> correlation_of_errors(std::span<const double> a, std::span<const double> b);

}  // namespace palpa::study
