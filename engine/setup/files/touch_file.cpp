#include "setup/files/touch_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "geometry/gltf_document/json.hpp"
#include "session/plan/voice.hpp"
#include "setup/files/voice_json.hpp"
#include "touch/methods/method.hpp"
#include "touch/types.hpp"

namespace palpa::setup {
namespace {

using geometry::gltf::Item;
using geometry::gltf::Json;

constexpr std::uint64_t most_bytes = 64u << 20;

/// The order in which sectors play, and their dwell.
struct Playing {
  std::vector<std::uint32_t> order;  ///< of foci
  bool together = false;             ///< all at once, not one after the other
  double dwell_s = 0;
};

Playing read_playing(const Item& item) {
  Order order = read_order(item);
  if (order.lists && order.foci.size() != order.foci_per_slot) item.fail("\"order\" has several slots of several foci");
  return {std::move(order.foci), order.lists, number(item, "dwell_s", shortest_dwell_s, longest_dwell_s)};
}

touch::Focus read_focus(const Item& finger, const Json& value) {
  touch::Focus focus;
  if (value.is_null()) return focus;  // an empty sector
  focus.points = 1;
  focus.position = glm::vec3(read_place(finger, value, true));
  return focus;
}

/// Returns whether its foci sound together.
bool read_voice(const Item& finger, std::uint32_t index, const Playing& common, array::Voice& voice) {
  const Json& foci = list_of_foci(finger);
  const auto own = finger.item("schedule");
  const Playing playing = own ? read_playing(*own) : common;
  touch::Placement placement;
  for (const Json& value : foci)
    placement.foci.push_back(read_focus(finger, value));
  if (std::ranges::all_of(placement.foci, [](const touch::Focus& focus) { return focus.points == 0; }))
    finger.fail("\"foci_m\" has no focus");
  placement.together = playing.together;

  array::VoiceOptions options;
  options.dwell_s = playing.dwell_s;
  if (finger.has("gain")) options.gain = number(finger, "gain", 0, 1);
  if (finger.has("asked_pa")) {
    const double asked = number(finger, "asked_pa", 0, array::most_pressure_pa);
    // a voice's request is for a gain of 1
    if (asked > 0 && options.gain > 0) options.pressure_pa = asked / options.gain;
  }
  options.modulation_hz = 0;
  session::make_voice(placement, index, 0, options, voice);
  for (const std::uint32_t sector : playing.order) {
    if (foci.size() > 1 && sector >= foci.size())
      finger.fail(fmt::format("its order plays focus {} of {} foci", sector, foci.size()));
  }
  if (placement.still()) return playing.together;  // one focus, or all of them at once: there is no order
  voice.order = playing.order;
  return false;
}

}  // namespace

PlayedTouch load_touch(const std::filesystem::path& file) {
  return read_touch(file.string(), read_text_file(file, most_bytes));
}

PlayedTouch read_touch(const std::string& name, const std::string& text) {
  const geometry::gltf::Parsed parsed(name, text);
  const Json& json = parsed.json();
  const auto has = [&](const char* key, Json::value_t type) { return json.contains(key) && json[key].type() == type; };
  if (!json.is_object() || !has("fingers", Json::value_t::array) || !has("schedule", Json::value_t::object))
    throw bad_input(name, "is not a touch: give a file that palpa touch --json wrote");
  if (json["fingers"].empty()) throw bad_input(name, "the touch has no finger: nothing sounds");
  if (json["fingers"].size() > touch::max_fingers) {
    throw bad_input(name, fmt::format("the touch has {} fingers; palpa touch writes at most {}", json["fingers"].size(),
                                      touch::max_fingers));
  }

  const Playing common = read_playing(Item(name, json["schedule"], "schedule"));
  PlayedTouch played{.schedule = {}, .together = common.together};
  array::Schedule& schedule = played.schedule;
  schedule.slot_s = longest_dwell_s;
  for (const Json& finger : json["fingers"]) {
    const std::uint32_t index = schedule.voice_count;
    array::Voice& voice = schedule.add_voice();
    const bool together = read_voice(Item(name, finger, fmt::format("finger {}", index)), index, common, voice);
    played.together = played.together || together;
    schedule.slot_s = std::min(schedule.slot_s, voice.dwell_s);
  }
  return played;
}

}  // namespace palpa::setup
