// Splits clusters that are several fingers side by side, and drops clusters that are no finger. The depth pictures of
// the cluster's own skin decide. This happens before patches are joined across hidden skin (bridge.hpp).
//
// - A cluster is a ghost if the pictures show a surface at less than half of its contacts. Such contacts are flying
//   pixels.
// - A cluster that is wider than a finger is several fingers if a valley is seen between them (docs/touch.md explains
//   how): along the way from contact to contact in a picture, the skin falls off and rises again.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "touch/fingers/known_labels.hpp"
#include "touch/fingers/parts.hpp"
#include "touch/fingers/sight.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Scratch that keeps its storage.
struct SplitWork {
  SplitWork();

  /// A cluster after the split.
  struct Cluster {
    std::uint32_t first = 0;  ///< its smallest contact
    std::uint32_t solid = 0;
    std::optional<std::uint32_t> finger{};  ///< the finger that it is; nothing: it is a part of one
    std::uint32_t begin = 0, count = 0;     ///< its contacts in `contacts`
  };
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> contacts;
  FingerSkins skins;
  /// A cluster that may be several fingers.
  struct Wide {
    std::uint32_t finger = 0;
    Parts parts;
    std::vector<std::uint8_t> part_of;                 ///< of its contacts
    std::array<std::uint32_t, most_samples> counts{};  ///< contacts of each part
  };
  std::vector<Wide> wide;        ///< in the order of their fingers; room for max_fingers
  std::uint32_t wide_count = 0;  ///< of this frame

  std::span<Wide> wide_now() { return std::span(wide).first(wide_count); }
};

/// Splits the fingers of `out`, whose contacts' points are pixels of the pictures. Fingers stay in the order of their
/// smallest contacts. Parts of fewer than min_points contacts are not fingers; half of that is enough for a part of a
/// known finger. With Cluster::inside, nothing is split. Fills `skins` for the fingers that it leaves. For many wide
/// clusters, it starts threads.
void split_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known, Touch& out,
                   FingerSkins& skins, SplitWork& work);

}  // namespace palpa::touch
