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

/// The fingers, contacts and foci of `snapshot`, and the skin of `seen`, which may be of a frame before or after it;
/// with `depth`, its images too.
void show_live(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, const Seen& seen, bool depth);
/// What the array gets in a slot, as the output thread has it; into `scratch` where it has to be computed. None where
/// nothing plays, and where the plan is of another array.
std::span<const array::TransducerDrive> drive_of(const LiveScene& scene, const session::Plan& plan, std::uint64_t slot,
                                                 session::SlotScratch& scratch);
/// Which focus of it sounds in `slot`, and its drive.
void show_live_slot(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, std::uint64_t slot,
                    session::SlotScratch& scratch);
/// What plays, valid as long as `snapshot`; no slot of it.
Sounding sounding_of(const std::shared_ptr<const LiveScene>& scene, const Snapshot& snapshot);

/// The scene's solids where `poses` take them, for a file of them.
std::vector<geometry::SceneMesh> meshes_of(const LiveScene& scene, const std::vector<Transform>& poses);

}  // namespace palpa::viewer
