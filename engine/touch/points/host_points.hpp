// Points in plain C++, on the calling thread.
#pragma once

#include <vector>

#include "sensing/rays.hpp"
#include "sensing/skin_twin.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/points/clusters_twin.hpp"
#include "touch/points/points.hpp"
#include "touch/stage_setting.hpp"

namespace palpa::touch {

/// There is room for any frame. Does its work in finish().
class HostPoints : public Points {
 public:
  /// `tables` and `solids` must outlive it. If there are cameras or if the setting gives the number of points, finish()
  /// allocates only if `out` grows, or for more than default_contacts contacts.
  HostPoints(const sensing::RayTables& tables, const PreparedSolids& solids, const StageSetting& setting);

  void start(const Skin& skin) override { frame_ = skin; }
  void finish(Touch& out, std::vector<gpu::PassTime>& times) override;

 private:
  const sensing::RayTables& tables_;
  const PreparedSolids& solids_;
  Skin frame_;
  // Scratch that keeps its storage.
  sensing::SkinOfFrame skin_;
  ClusterWork clusters_;
};

}  // namespace palpa::touch
