#include "setup/touch_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "geometry/gltf_document/json.hpp"
#include "session/plan/voice.hpp"
#include "touch/foci/method.hpp"
#include "touch/types.hpp"

namespace palpa::setup {
namespace {

using geometry::gltf::Item;
using geometry::gltf::Json;

constexpr std::uint64_t most_bytes = 64u << 20;
constexpr double shortest_dwell_s = 1e-6, longest_dwell_s = 10;

/// The order in which sectors play, and their dwell.
struct Playing {
  std::vector<std::uint32_t> order;  ///< of foci
  bool together = false;             ///< all at once, not one after the other
  double dwell_s = 0;
};

/// A member that is a number within [low, high].
double number(const Item& item, const char* key, double low, double high) {
  const auto found = item.json().find(key);
  if (found == item.json().end()) item.fail(fmt::format("\"{}\" is missing", key));
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  if (!(value >= low && value <= high)) item.fail(fmt::format("\"{}\" must be a number in {} to {}", key, low, high));
  return value;
}

Playing read_playing(const Item& item) {
  const Json* order = item.array("order");
  if (!order || order->empty()) item.fail("\"order\" is missing");
  Playing playing;
  playing.dwell_s = number(item, "dwell_s", shortest_dwell_s, longest_dwell_s);
  playing.together = order->front().is_array();
  if (playing.together && order->size() != 1) item.fail("\"order\" has several slots of several foci");
  for (const Json& sector : playing.together ? order->front() : *order) {
    const std::uint64_t place = sector.is_number_unsigned() ? sector.get<std::uint64_t>() : touch::max_foci;
    if (place >= touch::max_foci) item.fail(fmt::format("\"order\" must be numbers of foci below {}", touch::max_foci));
    playing.order.push_back(static_cast<std::uint32_t>(place));
  }
  return playing;
}

touch::Focus read_focus(const Item& finger, const Json& value) {
  touch::Focus focus;
  if (value.is_null()) return focus;  // an empty sector
  focus.points = 1;
  bool whole = value.is_array() && value.size() == 3;
  for (int axis = 0; whole && axis < 3; ++axis) {
    const Json& metres = value[static_cast<std::size_t>(axis)];
    whole = metres.is_number() && std::abs(metres.get<double>()) < 1e6;
    if (whole) focus.position[axis] = metres.get<float>();
  }
  if (!whole) finger.fail("\"foci_m\" must be places of three numbers in metres, or null");
  return focus;
}

/// Returns whether its foci sound together.
bool read_voice(const Item& finger, std::uint32_t index, const Playing& common, array::Voice& voice) {
  const Json* foci = finger.array("foci_m");
  if (!foci || foci->empty() || foci->size() > touch::max_foci) {
    finger.fail(fmt::format("\"foci_m\" must be a list of 1 to {} foci", touch::max_foci));
  }
  const auto own = finger.item("schedule");
  const Playing playing = own ? read_playing(*own) : common;
  touch::Placement placement;
  for (const Json& value : *foci)
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
    if (foci->size() > 1 && sector >= foci->size())
      finger.fail(fmt::format("its order plays focus {} of {} foci", sector, foci->size()));
  }
  if (placement.still()) return playing.together;  // one focus, or all of them at once: there is no order
  voice.order = playing.order;
  return false;
}

}  // namespace

PlayedTouch load_touch(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string text = read_file(file, most_bytes);
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
