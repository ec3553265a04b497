// What a live session shows, as a picture.
#pragma once

#include "viewer/live/live_session.hpp"

namespace palpa::viewer {

/// The fingers, contacts and foci of `snapshot`, and the skin of `seen`, which may be of a frame before or after it;
/// with `depth`, its images too.
void show_live(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, const Seen& seen, bool depth);
/// Which focus of it sounds in `slot`, and its drive.
void show_live_slot(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, std::uint64_t slot);

/// The scene's solids where `poses` take them, for a file of them.
std::vector<geometry::SceneMesh> meshes_of(const LiveScene& scene, const std::vector<Transform>& poses);

}  // namespace palpa::viewer
