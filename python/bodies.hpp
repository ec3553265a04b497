// Results of the boundary elements as Python objects.
#pragma once

#include <vector>

#include "setup/tasks/figure6.hpp"
#include "setup/tasks/scatter.hpp"
#include "setup/tasks/simulate_result.hpp"

namespace palpa::python {

/// `palpa.Scattering`.
struct ScatterObject {
  setup::ScatterResult result;
};

/// `palpa.Simulation`.
struct SimulateObject {
  setup::SimulateResult result;
};

/// `palpa.Figure6`.
struct Figure6Object {
  std::vector<setup::Figure6Touch> touches;
};

}  // namespace palpa::python
