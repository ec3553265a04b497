// The results of the paper's user study (its Tables I and II), as counts of 100 trials per shape.
#pragma once

#include <string>
#include <vector>

#include "study/tables/confusion.hpp"

namespace palpa::study {

Confusion paper_single_focus();   ///< Table I: 156 of 400 correct
Confusion paper_cross_section();  ///< Table II: 261 of 400 correct

/// The paper's shapes, in its order.
std::vector<std::string> paper_shapes();

}  // namespace palpa::study
