// From clusters of contacts to fingers with foci. At most max_fingers remain after clustering, so this is plain C++
// wherever the points come from. The passes and their twins decide only how many contacts a cluster needs, which
// clusters are the largest, and which contacts lie beyond the shell's edges. The steps of a frame, in their order:
//
//   split      a cluster that is several fingers, or no finger      split.hpp      } with cameras and a
//   bridge     several clusters that are one finger                 bridge.hpp     } finger width
//   admit      which clusters are fingers, by the frame before      admit.hpp        with hysteresis
//   sections   centroid and axes, Eq. (2)-(4)                       sections.hpp
//   follow     ids, steady axes                                     follow.hpp       if fingers are followed
//   keep       what the next frame must know                        keep.hpp         with hysteresis
//   foci       sectors' centroids, Eq. (5)-(7)                      sectors.hpp
//   glide      foci that do not jump                                glide.hpp        if foci are smoothed
//   beyond     contacts beyond the shell's edges are left out       keep.hpp         with hysteresis
//   depths     how deep a finger presses                            depths.hpp
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu/pass_time.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/fingers/follow.hpp"
#include "touch/fingers/glide.hpp"
#include "touch/fingers/known.hpp"
#include "touch/fingers/known_labels.hpp"
#include "touch/fingers/sight.hpp"
#include "touch/fingers/split.hpp"
#include "touch/points/points.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Remembers the fingers of the frames before. One object for each stream of frames.
class Fingers {
 public:
  /// `tables` and `solids` must outlive it.
  Fingers(const StageSetting& setting, std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
          const PreparedSolids& solids);

  /// The next frame was captured at `time_s`. Returns what its contacts depend on, valid until find().
  FingerReach next(double time_s);
  /// Makes fingers with foci of the clusters in `out`. `images`: the frame's, one per camera; none without cameras.
  /// `parameters`: those of its pixel stride. Adds the time of each step to `times`.
  void find(std::span<const sensing::DepthFrame> images, const FingerOptions& parameters, Touch& out,
            std::vector<gpu::PassTime>& times);
  /// The next frame is followed as if none had come before.
  void forget() {
    if (tracks_) tracks_->clock = {};
  }
  /// The id of the next new finger, if fingers are followed.
  std::uint32_t next_id() const { return tracks_ ? tracks_->next_id : 0; }
  void number_from(std::uint32_t id) {
    if (tracks_) tracks_->next_id = id;
  }

 private:
  const sensing::RayTables& tables_;
  const PreparedSolids& solids_;
  StageSetting setting_;
  std::vector<SightCamera> cameras_;
  std::optional<Tracks> tracks_;
  std::optional<GlideMemory> glide_memory_;
  std::unique_ptr<KnownFingers> known_;      // the fingers of the frame before; null unless they decide
  std::optional<std::uint32_t> elapsed_us_;  // from the frame before to this one
  bool has_before_ = false;                  // whether `known_` is of the frame before
  FingerSkins skins_;
  SplitWork split_work_;
  std::vector<std::uint32_t> places_;  // scratch
};

}  // namespace palpa::touch
