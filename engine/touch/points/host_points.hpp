// Points in plain C++, on the calling thread.
#pragma once

#include <vector>

#include "sensing/rays.hpp"
#include "sensing/skin_twin.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/points/points.hpp"

namespace palpa::touch {

/// There is room for any frame. Does its work in finish().
class HostPoints : public Points {
 public:
  /// Both must outlive it.
  HostPoints(const sensing::RayTables& tables, const PreparedSolids& solids) : tables_(tables), solids_(solids) {}

  void start(const Skin& skin) override { frame_ = skin; }
  void finish(Touch& out, std::vector<gpu::PassTime>& times) override;

 private:
  const sensing::RayTables& tables_;
  const PreparedSolids& solids_;
  Skin frame_;
  sensing::SkinOfFrame skin_;  // scratch
};

}  // namespace palpa::touch
