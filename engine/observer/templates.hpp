// What the ideal observer expects to feel of each shape at each placement, and how far these expectations are apart.
#pragma once

#include <cstddef>
#include <vector>

#include "observer/responses.hpp"
#include "observer/variants.hpp"

namespace palpa::observer {

/// Expectations as points of a space in which the internal noise is the same in all directions. Only their scalar
/// products are kept, because a decision needs nothing else. Template (shape * placements + placement) * nodes + node.
struct Templates {
  std::size_t shapes = 0, placements = 0;
  std::vector<double> node_weights;  ///< of the offsets of depth, their sum is 1; one unless they are unknown
  std::vector<double> products;      ///< by rows
  Placement placement = Placement::unknown;

  std::size_t nodes() const { return node_weights.size(); }
  std::size_t size() const { return shapes * placements * nodes(); }
  double square(std::size_t a, std::size_t b) const {
    return products[a * size() + a] + products[b * size() + b] - 2 * products[a * size() + b];
  }
};

/// The templates of one method at one level (an index into the levels of the responses). Counts are those of
/// `seconds_per_depth`.
Templates templates_of(const Responses& responses, std::size_t method, const Variant& variant, std::size_t level,
                       double seconds_per_depth);

/// The mean distance (root mean square) of templates of different shapes at the same placement.
double spread_of(const Templates& templates);

}  // namespace palpa::observer
