// Results of people beside a prediction. The prediction is complete before they are read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "observer/prediction.hpp"
#include "study/tables/confusion.hpp"

namespace palpa::observer {

/// How a predicted table compares with an observed one.
struct TableFit {
  double rms = 0;                  ///< of the differences of shares
  std::optional<double> errors_r;  ///< correlation of the shares off the diagonal
  double log_likelihood = 0;       ///< per trial, of the observed answers (shares of 0 count as 0.001)
};

struct ObservedMethod {
  std::size_t method = 0;  ///< of the prediction
  std::string source;
  study::Confusion table;                 ///< in the order of the prediction's shapes
  std::vector<TableFit> variants, nulls;  ///< in the order of the prediction; of variants without fit, all is 0
  TableFit chance, itself;                ///< of equal shares, and of the observed shares
  /// What a perfect prediction of the shares behind the table would reach, since the table has few trials.
  double ceiling_rms = 0;
  std::optional<double> ceiling_r;
};

/// The observed table of a method, by its name.
struct ObservedTable {
  std::string method, source;
  study::Confusion table;
};

struct Comparison {
  std::vector<ObservedMethod> methods;
  std::vector<std::string> left_out;  ///< a line for each table that belongs to no method or has other shapes
};

Comparison compare(const Prediction& prediction, const std::vector<ObservedTable>& observed);

}  // namespace palpa::observer
