// The stream of foci: with it, palpa can drive any other array's SDK, a game engine or a script.
//
// One UDP datagram per frame, one JSON object and a newline:
//   {"time_s": 12.5, "fingers": [{"id": 0, "solid": "cube", "foci_m": [[x,y,z], ...], "order": [0,3,6,...],
//    "dwell_s": 0.0015, "modulation_hz": 0, "gain": 1}]}
//
// Foci that sound together are a list within `order`: [[0,1,2]]. If `modulation_hz` is not 0, `modulation` says which
// quantity is a sine: "pressure-sine" or "amplitude-sine". Positions are in the world. If a pressure is requested,
// "pressure_pa" is the part of it that sounds. If a gain changes from slot to slot, "gains" has a factor of it for each
// slot of "slot_s" from the first one on that plays the line; the last one stays. No fingers mean silence. Silence is
// also sent when foci expire, and instead of a line that cannot be sent (a datagram holds 65,507 bytes). At the end, it
// is sent a few times, because a datagram may get lost. A receiver that hears nothing for the hold time must go silent.
// `time_s` is the frame's capture time on the source's clock.
#pragma once

#include <memory>
#include <string>

#include "base/files/json_writer.hpp"
#include "session/links/link.hpp"
#include "session/links/slots.hpp"

namespace palpa::session {

/// Link "foci:udp:HOST:PORT". Throws bad_usage for another form, failure() for a host that does not resolve.
std::unique_ptr<Link> open_foci_link(const std::string& argument, const LinkSetting& setting);

/// The order in which a voice's foci play: [0,3,...], or [[0,1,...]] if several sound together.
void write_order(const array::Voice& voice, JsonWriter& json);

/// All gains of a line. A datagram has to hold them.
inline constexpr std::uint64_t most_gains = 2048;

/// Writes the line as a complete document; `json` is cleared first and keeps its storage. `slots`: those that play it,
/// for gains that change. Returns false if the line has the gains of the first of these slots only, because all fingers
/// share most_gains.
bool write_foci_line(const array::Schedule& schedule, const Slots& slots, std::span<const std::string> solid_names,
                     JsonWriter& json);

/// Warns of it.
void warn_of_cut_gains(const std::string& name);

}  // namespace palpa::session
