// How long a case takes, and how much memory it needs: models with measured constants.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "setup/options.hpp"
#include "sweep/commands.hpp"
#include "sweep/inputs.hpp"
#include "sweep/plan.hpp"

namespace palpa::sweep {

/// Times are those of two idle cores of a machine of 2023.
struct Cost {
  double seconds = 0;      ///< with the software device
  double cpu_seconds = 0;  ///< with --backend cpu
  double first_s = 0;      ///< besides, for the first case with its model and delta: what later ones find in the cache
  double bytes = 0;        ///< of memory, beyond what the process needs for any case
  /// What the case takes, of either kind.
  double all_s(setup::Backend backend) const {
    return (backend == setup::Backend::cpu ? cpu_seconds : seconds) + first_s;
  }
};

/// The costs of a plan's cases. Files are read once, and cases that differ only in options without effect on the cost
/// are estimated once. A case whose files or options are faulty costs nothing: it ends at once.
class Estimator {
 public:
  Estimator(const Plan& plan, const Inputs& inputs);

  /// `settings` as in the plan. The same on every machine, if the cases come in the same order.
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
  /// The faces of a model's solids, by what is done with them.
  struct Faces {
    double convex = 0, concave = 0;  ///< sorted into a grid for each case
    double kept = 0;                 ///< into one that is kept for its delta
    double all() const { return convex + concave + kept; }
  };
  const Faces& model(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
                     const setup::SolidOptions& options);
  /// What it costs to prepare the solids of a model for touches.
  Cost prepare(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
               const setup::SolidOptions& options);

  const Plan& plan_;
  const Inputs& inputs_;
  std::map<std::string, Cost> known_;
  std::map<std::string, double> transducers_, points_, faces_;
  std::map<std::string, Faces> models_;
  std::set<std::string> prepared_;  ///< models with their delta
};

}  // namespace palpa::sweep
