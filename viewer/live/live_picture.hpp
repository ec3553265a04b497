// What a live session shows, as a picture.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "session/loop/output.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/sound/sounding.hpp"

namespace palpa::viewer {

/// Shows the fingers, contacts and foci of `snapshot`, and the skin of `seen`, which may be of an earlier or later
/// frame. With `depth`, also shows the images of `seen`.
void show_live(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, const Seen& seen, bool depth);
/// The drive that the array gets in a slot, as the output thread has it. If it must be computed, it is written to
/// `scratch`. Empty if nothing plays, or if the plan is for another array.
std::span<const array::TransducerDrive> drive_of(const LiveScene& scene, const session::Plan& plan, std::uint64_t slot,
                                                 session::SlotScratch& scratch);
/// Shows which focus of `snapshot` sounds in `slot`, and its drive.
void show_live_slot(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, std::uint64_t slot,
                    session::SlotScratch& scratch);
/// What plays, without any slot. Valid as long as `snapshot`.
Sounding sounding_of(const std::shared_ptr<const LiveScene>& scene, const Snapshot& snapshot);

/// The scene's solids, moved by `poses`, for writing them to a file.
std::vector<geometry::SceneMesh> meshes_of(const LiveScene& scene, const std::vector<Transform>& poses);

}  // namespace palpa::viewer
