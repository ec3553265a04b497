// All pipelines of touching. One for a device, whatever number of stages works on it.
#pragma once

#include <mutex>
#include <optional>

#include "sensing/skin_pass.hpp"
#include "touch/bridge/bridge_pass.hpp"
#include "touch/contacts/contacts_pass.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/fingers/fingers_pass.hpp"
#include "touch/foci/foci_pass.hpp"
#include "touch/follow/follow_pass.hpp"
#include "touch/follow/glide_pass.hpp"
#include "touch/sections/sections_pass.hpp"
#include "touch/split/split_pass.hpp"
#include "touch/stage_setting.hpp"

namespace palpa::touch {

/// A stage tells the passes what it needs when it is made; what others have asked for before is there already. So no
/// pipeline is made while frames run, and none that nobody needs. `device` outlives it.
class Passes {
 public:
  explicit Passes(const gpu::Device& device);
  Passes(const Passes&) = delete;
  Passes& operator=(const Passes&) = delete;

  const gpu::Device& device() const { return device_; }

 private:
  friend class Stage;
  /// Makes what is missing for frames of these. Other threads may go on recording what they are prepared for.
  void prepare(const PreparedSolids& solids, const sensing::RayTables& tables, const StageSetting& setting);

  const gpu::Device& device_;
  std::mutex making_;
  sensing::SkinPass skin_;
  ContactsPass contacts_;
  FingersPass fingers_;
  std::optional<SplitPass> split_;
  std::optional<BridgePass> bridge_;
  SectionsPass sections_;
  std::optional<FollowPass> follow_;
  FociPass foci_;
  std::optional<GlidePass> glide_;
};

}  // namespace palpa::touch
