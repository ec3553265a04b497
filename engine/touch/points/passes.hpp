// All pipelines of touching. One object per device, shared by all stages on it.
#pragma once

#include <mutex>

#include "sensing/skin_pass.hpp"
#include "touch/contacts/contacts_pass.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/points/clusters_pass.hpp"
#include "touch/stage_setting.hpp"

namespace palpa::touch {

/// Each stage requests the pipelines it needs when it is made. Pipelines that exist already are reused. No pipeline is
/// made while frames run, and none is made that no stage needs. `device` must outlive this object.
class Passes {
 public:
  explicit Passes(const gpu::Device& device);
  Passes(const Passes&) = delete;
  Passes& operator=(const Passes&) = delete;

  const gpu::Device& device() const { return device_; }

 private:
  friend class DevicePoints;
  /// Makes the pipelines that are missing for these arguments. Meanwhile, other threads may record with pipelines that
  /// are already prepared.
  void prepare(const PreparedSolids& solids, const sensing::RayTables& tables, const StageSetting& setting);

  const gpu::Device& device_;
  std::mutex making_;
  sensing::SkinPass skin_;
  ContactsPass contacts_;
  ClustersPass clusters_;
};

}  // namespace palpa::touch
