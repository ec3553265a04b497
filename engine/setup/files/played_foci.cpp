#include "setup/files/played_foci.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/words.hpp"
#include "session/links/foci_link.hpp"
#include "setup/files/voice_json.hpp"
#include "touch/types.hpp"

namespace palpa::setup {
namespace {

using geometry::gltf::Item;
using geometry::gltf::Json;

constexpr std::uint64_t most_bytes = 256U << 20;
constexpr std::uint64_t most_slot = std::uint64_t{1} << 52;
constexpr double most_time_s = 1e12;  // as in a recording
constexpr double most_hz = 1e6;

std::uint32_t solid_named(std::string name, std::vector<std::string>& solids) {
  const auto found = std::ranges::find(solids, name);
  if (found == solids.end()) {
    solids.push_back(std::move(name));
    return static_cast<std::uint32_t>(solids.size() - 1);
  }
  return static_cast<std::uint32_t>(found - solids.begin());
}

/// Gains that change from slot to slot; empty if they do not.
std::vector<double> read_gains(const Item& finger, double slot_s) {
  std::vector<double> gains;
  const Json* list = finger.array("gains");
  if (!list) return gains;
  if (list->empty() || list->size() > session::most_gains)
    finger.fail(fmt::format("\"gains\" must be 1 to {} numbers from 0 to 1", session::most_gains));
  if (std::abs(number(finger, "slot_s", shortest_dwell_s, longest_dwell_s) - slot_s) > 1e-9)
    finger.fail(fmt::format("its gains are for slots of another length than the file's, {} s", slot_s));
  for (const Json& gain : *list) {
    gains.push_back(gain.is_number() ? gain.get<double>() : -1);
    if (!(gains.back() >= 0 && gains.back() <= 1)) finger.fail("\"gains\" must be numbers from 0 to 1");
  }
  return gains;
}

void read_voice(const Item& finger, std::uint64_t slot, double slot_s, std::vector<std::string>& solids,
                array::Voice& voice) {
  voice = {};
  voice.id = static_cast<std::uint32_t>(finger.needed_whole("id", 0, ~std::uint32_t{0}));
  voice.solid = solid_named(finger.string("solid").value_or(""), solids);
  for (const Json& value : list_of_foci(finger))
    voice.foci.push_back(read_place(finger, value, false));
  Order order = read_order(finger);
  if (const std::uint32_t most = std::ranges::max(order.foci); most >= voice.foci.size())
    finger.fail(fmt::format("its order plays focus {} of {} foci", most, voice.foci.size()));
  voice.order = std::move(order.foci);
  voice.foci_per_slot = order.foci_per_slot;
  voice.dwell_s = number(finger, "dwell_s", slot_s, longest_dwell_s);
  voice.modulation_hz = number(finger, "modulation_hz", 0, most_hz);
  if (const std::optional<std::string> word = finger.string("modulation")) {
    const std::optional<array::Modulation> modulation = value_of(array::modulation_words, *word);
    if (!modulation) finger.fail(fmt::format("\"modulation\" must be {}", one_of(array::modulation_words)));
    voice.modulation = *modulation;
  }
  voice.gain = number(finger, "gain", 0, 1);
  voice.course.first_slot = slot;
  voice.course.gains = read_gains(finger, slot_s);
  if (!finger.has("pressure_pa")) return;
  const double pressure_pa = number(finger, "pressure_pa", 0, array::most_pressure_pa);
  if (pressure_pa == 0) return;
  voice.pressure_pa = pressure_pa;
  voice.gain = 1;
}

void read_frame(const Item& frame, session::PlayedFoci& played) {
  session::PlayedFoci::Frame out;
  out.slot = frame.needed_whole("slot", played.frames.empty() ? 0 : played.frames.back().slot, most_slot);
  array::Schedule& schedule = out.schedule;
  schedule.slot_s = played.slot_s;
  schedule.time_s = number(frame, "time_s", -most_time_s, most_time_s);
  const Json* fingers = frame.array("fingers");
  if (!fingers) frame.fail("\"fingers\" is missing");
  if (fingers->size() > touch::max_fingers)
    frame.fail(fmt::format("it has {} fingers; palpa plays at most {}", fingers->size(), touch::max_fingers));
  for (const Json& finger : *fingers) {
    const std::string where = fmt::format("{}, finger {}", frame.where(), schedule.voice_count);
    read_voice(Item(frame.file(), finger, where), out.slot, played.slot_s, played.solids, schedule.add_voice());
  }
  played.frames.push_back(std::move(out));
}

}  // namespace

session::PlayedFoci load_played_foci(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string text = read_text_file(file, most_bytes);
  const geometry::gltf::Parsed parsed(name, text);
  const Json& json = parsed.json();
  if (!json.is_object() || !json.contains("slot_s") || !json.contains("frames") || !json["frames"].is_array())
    throw bad_input(name, "is not a file of foci: give a .json that palpa export --foci or a study wrote");
  session::PlayedFoci played;
  played.slot_s = number(Item(name, json, "the file"), "slot_s", shortest_dwell_s, longest_dwell_s);
  for (const Json& frame : json["frames"])
    read_frame(Item(name, frame, fmt::format("frame {}", played.frames.size())), played);
  if (played.frames.empty()) throw bad_input(name, "has no frame: nothing was played");
  return played;
}

}  // namespace palpa::setup
