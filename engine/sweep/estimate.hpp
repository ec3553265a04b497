// How long a case takes, and how much memory it needs: models with measured constants.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sweep/commands.hpp"
#include "sweep/inputs.hpp"
#include "sweep/plan.hpp"

namespace palpa::sweep {

struct Cost {
  double seconds = 0;  ///< on two cores of a machine of 2023, with the software device
  double bytes = 0;    ///< of memory, beyond what the process needs for any case
};

/// The costs of a plan's cases. Files are read once, and cases that differ only in options without effect on the cost
/// are estimated once. A case whose files or options are faulty costs nothing: it ends at once.
class Estimator {
 public:
  Estimator(const Plan& plan, const Inputs& inputs);

  /// `settings` as in the plan. The same on every machine.
  Cost cost(const std::vector<Setting>& settings);

 private:
  Cost estimate(const std::vector<Setting>& settings);
  Cost of(const setup::TouchLine& line);
  Cost of(const setup::DriveLine& line);
  Cost of(const setup::FieldLine& line);
  Cost of(const setup::SimulateLine& line);
  double transducers(const std::string& layout);
  double points(const std::string& file);
  double faces(const std::string& file);
  double megabytes(const std::string& file);

  const Plan& plan_;
  const Inputs& inputs_;
  std::map<std::string, Cost> known_;
  std::map<std::string, double> transducers_, points_, faces_;
};

}  // namespace palpa::sweep
