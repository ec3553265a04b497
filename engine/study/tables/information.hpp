// What the answers of a table tell about the shapes.
#pragma once

#include "study/tables/confusion.hpp"

namespace palpa::study {

struct Information {
  double bits = 0;            ///< transmitted information: mutual information of shape and answer
  double corrected_bits = 0;  ///< less the bias of a small sample (Miller and Madow); may be below 0
  double most_bits = 0;       ///< entropy of the shapes, which perfect answers transmit
  double chi_square = 0;      ///< of independence of shape and answer
};
/// All 0 without trials.
Information information(const Confusion& table);

}  // namespace palpa::study
