// The twin of the stage (stage.hpp): from skin to foci through the passes' C++ twins on the calling thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "sensing/skin_twin.hpp"
#include "shaders/touch/bridge/bridge.h"
#include "shaders/touch/known/known.h"
#include "touch/bridge/bridge_twin.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/follow/follow_twin.hpp"
#include "touch/follow/glide_twin.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

class HostStage {
 public:
  /// Called after each part with its name: "skin", "contacts", "fingers", "split", "bridge", "sections", "follow",
  /// "foci", "glide"; and, with hysteresis, "admit" after "bridge" and "keep" after "follow".
  using Mark = std::function<void(const char*)>;

  /// Without cameras, every frame is a set of skin points. There is room for any frame, and contacts are always filled
  /// in, whatever the setting's detail. Throws bad_usage for invalid solids, cameras and parameters.
  explicit HostStage(const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras = {},
                     const StageSetting& setting = {});

  const StageSetting& setting() const { return setting_; }
  const std::vector<sensing::Camera>& cameras() const { return cameras_; }
  const sensing::RayTables& rays() const { return tables_; }
  const PreparedSolids& solids() const { return solids_; }
  /// Takes effect from the next touch(); see touch::set_pose.
  void set_pose(std::uint32_t solid, const Transform& T_world_rest) { touch::set_pose(solids_, solid, T_world_rest); }

  /// See Stage.
  void set_pixel_stride(std::uint32_t stride) { stride_ = stride; }
  std::uint32_t most_pixel_stride() const;

  /// Computes the touch of the frame captured at `time_s`, from one image per camera or from points with ascending
  /// indices. If fingers are followed, frames must come in the order of their capture. Throws bad_usage for images that
  /// do not fit the cameras.
  void touch(std::span<const sensing::DepthFrame> images, Touch& out, double time_s = 0, const Mark& mark = {});
  void touch(std::span<const sensing::SkinPoint> points, Touch& out, double time_s = 0, const Mark& mark = {});

 private:
  void touch(std::span<const sensing::SkinPoint> points, const Sight* sight, Touch& out, double time_s,
             const Mark& mark);

  StageSetting setting_;
  std::vector<sensing::Camera> cameras_;
  sensing::RayTables tables_;
  std::vector<shader::BridgeCamera> bridge_cameras_;
  PreparedSolids solids_;
  std::optional<Tracks> tracks_;
  std::optional<Homes> homes_;
  std::unique_ptr<shader::KnownTable> known_;  // the fingers of the frame before; null unless they decide
  std::uint32_t stride_ = 1;
  std::vector<sensing::Crop> crops_;         // scratch
  std::vector<shader::SkinVolume> volumes_;  // scratch
  sensing::SkinOfFrame skin_;                // scratch
};

}  // namespace palpa::touch
