// The paper's Fig. 6: the finger in each of the paper's objects, with every method.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "setup/tasks/simulate.hpp"

namespace palpa::setup {

/// "cube", "semi-sphere", "pyramid", "prism", or "prism-along-x", whose ridge runs along x.
struct Figure6Touch {
  std::string object;
  SimulateResult result;  ///< includes bare_elongation
};

/// The results of simulate(), method by method and object by object; the objects are palpa's own assets. In `options`,
/// the method and the request for the bare elongation are ignored.
std::vector<Figure6Touch> figure6(const SimulateTask& options, FingerBody& finger);

/// The output of `palpa simulate --figure6 --json`: an array of objects.
std::string to_json(std::span<const Figure6Touch> touches);

}  // namespace palpa::setup
