// The paper's Fig. 6: the finger in each of its objects, by every method.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "setup/tasks/simulate.hpp"

namespace palpa::setup {

/// "cube", "semi-sphere", "pyramid", "prism", or "prism-along-x", whose ridge runs along x.
struct Figure6Touch {
  std::string object;
  SimulateResult result;  ///< has its bare_elongation
};

/// Method by method, object by object, each as simulate() has it; the objects are palpa's own assets. Of `options` the
/// method, and whether the bare elongation is asked for, do not matter.
std::vector<Figure6Touch> figure6(const SimulateOptions& options, FingerBody& finger);

/// As `palpa simulate --figure6 --json` writes it: an array of objects.
std::string to_json(std::span<const Figure6Touch> touches);

}  // namespace palpa::setup
