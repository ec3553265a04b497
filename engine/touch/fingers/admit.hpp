// Which clusters are fingers, by the fingers of the frame before. This is decided after clusters are split and joined.
// - The largest cluster of a known finger, its heir, is a finger with half of min_points contacts; any other cluster
//   needs min_points.
// - An island becomes a finger only after it has been there for 50 ms. An island is any of:
//   (a) a small cluster beside a known finger;
//   (b) a cluster of no known finger with fewer than 2 min_points contacts;
//   (c) a cluster of no known finger, where one has just ended, with fewer than min_points contacts 0.3 mm deep.
// - A cluster that is both (b) and (c) is no finger, even after 50 ms.
// - Skin of a known finger that does not become a finger of its own is the heir's.
// - Skin of no known finger that does not become one goes to the heir of the nearest one, if it is within the gap of
//   that heir.
#pragma once

#include <array>

#include "touch/fingers/known_labels.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// What goes on from the fingers of the frame before in each finger that stays.
using Continuations = std::array<Continuation, max_fingers>;

/// Removes the clusters of `out`, and their `skins`, that are no fingers. Writes the frame's islands and the fingers
/// that have ended to `table`, to which `known` also refers unless there are no known fingers. Ends the doubts of the
/// table.
Continuations admit_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known,
                            KnownFingers& table, Touch& out, FingerSkins& skins);

}  // namespace palpa::touch
