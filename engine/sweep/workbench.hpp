// What the cases that one process computes share: the device with its pipelines, models and fingers that were loaded.
// A case gives the same result whatever was computed before it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "geometry/solid.hpp"
#include "setup/options.hpp"
#include "setup/tasks/simulate.hpp"
#include "sweep/commands.hpp"

namespace palpa::sweep {

class Workbench {
 public:
  /// Opens the device of these options, unless the backend is the processor. Throws as gpu::Device does.
  explicit Workbench(const setup::ComputeOptions& compute);
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;

  /// The device's name and driver; "the processor" without a device.
  std::string device_name() const;

  /// Computes a case. Returns the output of `palpa COMMAND --json`. Throws as the command does.
  std::string compute(Line& line);

 private:
  struct Model {
    std::string key;
    std::vector<geometry::Solid> solids;
  };
  struct Finger {
    std::string key;
    std::unique_ptr<setup::FingerBody> body;
  };

  std::string compute(setup::TouchLine& line);
  std::string compute(setup::DriveLine& line);
  std::string compute(setup::FieldLine& line);
  std::string compute(setup::SimulateLine& line);
  void set(setup::CommonOptions& common) const;
  std::vector<geometry::Solid> solids(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
                                      const setup::SolidOptions& options);
  setup::FingerBody& finger(const std::string& file, const acoustics::Air& air, bool force);

  setup::ComputeOptions compute_;
  std::vector<Model> models_;  ///< the newest last
  std::optional<Finger> finger_;
};

}  // namespace palpa::sweep
