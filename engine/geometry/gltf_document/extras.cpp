#include "geometry/gltf_document/extras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/nearest_word.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

const std::array<std::string, 14> keys{"touchable", "delta_m",     "foci",          "stride", "dwell_s",
                                       "intensity", "pressure_pa", "press_depth_m", "click",  "stiffness",
                                       "texture",   "grain_m",     "part_of",       "seam_m"};

constexpr std::string_view own_name = "palpa", prefix = "palpa_";

/// Letters and digits alone, in lower case.
std::string squashed(std::string_view text) {
  std::string letters;
  for (const char c : text) {
    if (c >= 'A' && c <= 'Z') letters += static_cast<char>(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) letters += c;
  }
  return letters;
}

/// The known key that is spelt like this, or nearly; empty if there is none.
std::string key_like(std::string_view spelt) {
  const std::string letters = squashed(spelt);
  const auto same = std::ranges::find(keys, letters, squashed);
  if (same != keys.end()) return *same;
  const auto without_unit = std::ranges::find_if(
      keys, [&](const std::string& known) { return letters.size() >= 4 && squashed(known).starts_with(letters); });
  return without_unit != keys.end() ? *without_unit : nearest_word(spelt, keys);
}

/// Without the spaces and signs before it, also those of Unicode.
std::string_view from_letter(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of("_-.: \t\r\n\xC2\xA0\xEF\xBB\xBF"), text.size()));
}

/// Whether a key is palpa's in another spelling, such as palpa-foci, palpaFoci, " palpa_foci" or palpafoci, and
/// not another word, such as palpable.
bool is_misspelt(const std::string& key) {
  const std::string_view bare = from_letter(key);
  if (key == own_name || key.starts_with(prefix) || !squashed(bare.substr(0, own_name.size())).starts_with(own_name))
    return false;
  const std::string_view rest = bare.substr(own_name.size());
  const bool goes_on = !rest.empty() && rest[0] >= 'a' && rest[0] <= 'z';
  return !goes_on || std::ranges::find(keys, squashed(rest), squashed) != keys.end();
}

bool has_palpa_keys(const Json& extras) {
  if (!extras.is_object()) return false;
  for (const auto& [key, value] : extras.items()) {
    if (key == "palpa" || key.starts_with(prefix) || is_misspelt(key)) return true;
  }
  return false;
}

bool has_palpa_extras(const Json& item) {
  if (!item.is_object()) return false;
  const auto found = item.find("extras");
  return found != item.end() && has_palpa_keys(*found);
}

/// The places in an item with such keys, such as "material 0" or "mesh 1, primitive 0"; empty for the item itself.
std::vector<std::string> places_in(const Json& item) {
  std::vector<std::string> places;
  if (has_palpa_extras(item)) places.emplace_back();
  const auto look_at = [&](const Json& part, const std::string& called) {
    if (!part.is_structured()) return;
    for (const std::string& place : places_in(part))
      places.push_back(printable(called, 40) + (place.empty() ? "" : ", ") + place);
  };
  for (const auto& [key, value] : item.items()) {
    if (key == "extras") continue;
    if (value.is_object()) look_at(value, key);
    if (!value.is_array() || value.empty() || !value.front().is_structured()) continue;
    const std::string one = key.substr(0, key.size() - (key == "meshes" ? 2 : key.ends_with('s') ? 1 : 0));
    for (std::size_t i = 0; i < value.size(); ++i)
      look_at(value[i], fmt::format("{} {}", one, i));
  }
  return places;
}

struct Range {
  double low, high;
  bool open;  // excludes its low end
};

// One value with the name under which its author wrote it.
struct Entry {
  const Item& node;
  const std::string& name;
  const Json& value;

  [[noreturn]] void fail(const std::string& fault) const {
    node.fail(fmt::format("extras: {} {}", text::quoted(name), fault));
  }
  [[noreturn]] void refuse(const std::string& right) const {
    const std::string shown = printable(value.dump(-1, ' ', false, Json::error_handler_t::replace), 30);
    fail(fmt::format("is {}; it must be {}", shown, right));
  }

  double number(const Range& range, const char* unit) const {
    const double x = value.is_number() ? value.get<double>() : std::nan("");
    if (!(range.open ? x > range.low : x >= range.low) || !(x <= range.high)) {
      refuse(fmt::format("a number {}{} and at most {}{}", range.open ? "above " : "of at least ", range.low,
                         range.high, unit));
    }
    return x;
  }

  // Blender writes 10.0 if a property was created as a float.
  std::uint32_t whole(std::uint32_t low, std::uint32_t high) const {
    const double x = value.is_number() ? value.get<double>() : -1;
    if (!(x >= low && x <= high) || x != std::floor(x)) refuse(fmt::format("a whole number from {} to {}", low, high));
    return static_cast<std::uint32_t>(x);
  }

  // The numbers of a list; empty if it is not one.
  std::vector<double> numbers() const {
    std::vector<double> list;
    if (!value.is_array()) return list;
    for (const Json& number : value) {
      if (!number.is_number()) return {};
      list.push_back(number.get<double>());
    }
    return list;
  }

  Click click() const {
    if (value.is_boolean() || value == 0 || value == 1) return truth() ? Click{} : Click{.burst_s = 0};
    const std::optional<Click> click = click_of(numbers());
    if (!click) refuse("true, false, or the burst's length and frequency: [0.03 to 0.06 seconds, 150 to 200 Hz]");
    return *click;
  }

  std::vector<DepthForce> stiffness() const {
    const std::vector<double> list = numbers();
    std::vector<DepthForce> table;
    if (list.empty() || list.size() % 2 != 0 || list.size() > 2 * most_stiffness_rows)
      refuse("a list of 1 to 32 pairs, a depth in metres and the force there, such as [0, 0.1, 0.004, 1]");
    for (std::size_t i = 0; i < list.size(); i += 2) {
      const DepthForce row{list[i], list[i + 1]};
      if (const std::string fault = row_fault(table, row); !fault.empty()) fail(fault);
      table.push_back(row);
    }
    return table;
  }

  std::array<double, 3> texture() const {
    const std::optional<std::array<double, 3>> weights = texture_of(numbers());
    if (!weights) refuse("the weights of [steady, 30 Hz, 150 Hz], each from 0 to 1 and not all 0");
    return *weights;
  }

  std::string name_of_solid() const {
    if (!value.is_string() || value.get_ref<const std::string&>().empty())
      refuse("the name of the solid that this is a part of");
    return value.get<std::string>();
  }

  bool truth() const {
    if (value == true || value == 1) return true;
    if (value == false || value == 0) return false;
    refuse("true or false");
  }
};

// Returns false if the key is unknown.
bool take(NodeHaptics& into, std::string_view key, const Entry& entry) {
  Haptics& h = into.values;
  if (key == "touchable") {
    into.touchable = entry.truth();
  } else if (key == "delta_m") {
    h.delta_m = entry.number({0, 0.1, true}, " metres");
  } else if (key == "foci") {
    h.foci = entry.whole(1, 64);
  } else if (key == "stride") {
    h.stride = entry.whole(1, 1U << 20);
  } else if (key == "dwell_s") {
    h.dwell_s = entry.number({1e-6, 10, false}, " seconds");
  } else if (key == "intensity") {
    h.intensity = entry.number({0, 1, false}, "");
  } else if (key == "pressure_pa") {
    h.pressure_pa = entry.number({0, 1e5, true}, " pascals");
  } else if (key == "press_depth_m") {
    h.press_depth_m = entry.number({0, 1, true}, " metres");
  } else if (key == "click") {
    h.click = entry.click();
  } else if (key == "stiffness") {
    h.stiffness = entry.stiffness();
  } else if (key == "texture") {
    h.texture = entry.texture();
  } else if (key == "grain_m") {
    h.grain_m = entry.number({1e-4, 0.1, false}, " metres");
  } else if (key == "part_of") {
    into.part_of = entry.name_of_solid();
  } else if (key == "seam_m") {
    into.seam_m = entry.number({0, 1, false}, " metres");
  } else {
    return false;
  }
  return true;
}

}  // namespace

NodeHaptics read_extras(const Item& node, UnknownKeys& unknown) {
  NodeHaptics result;
  const auto found = node.json().find("extras");
  // Extras may be any value; palpa's are in an object.
  if (found == node.json().end() || !found->is_object()) return result;
  const auto remember = [&](const std::string& key) {
    // A file can have any number of unknown keys; one line each is enough, up to a limit.
    if (unknown.size() < 8) unknown.emplace(key, node.where());
  };
  const Json* group = nullptr;
  if (const auto palpa = found->find("palpa"); palpa != found->end()) {
    if (!palpa->is_object()) {
      node.fail(
          "extras: \"palpa\" is not a JSON object; write {\"palpa\": {\"delta_m\": 0.0015}} or {\"palpa_delta_m\": "
          "0.0015}");
    }
    group = &*palpa;
    for (const auto& [key, value] : group->items()) {
      if (!take(result, key, {node, key, value})) remember(key);
    }
  }
  for (const auto& [name, value] : found->items()) {
    if (is_misspelt(name)) remember(name);
    if (!name.starts_with(prefix)) continue;
    const std::string key = name.substr(prefix.size());
    const Entry entry{node, name, value};
    if (group != nullptr && group->contains(key)) entry.fail(fmt::format("is also given in \"palpa\"; give it once"));
    if (!take(result, key, entry)) remember(name);
  }
  return result;
}

Haptics inherit(const Item& node, const NodeHaptics& own, const Haptics& parent) {
  const Haptics& v = own.values;
  const auto either = [](const auto& mine, const auto& theirs) { return mine ? mine : theirs; };
  Haptics h{own.touchable.value_or(parent.touchable),
            either(v.delta_m, parent.delta_m),
            either(v.dwell_s, parent.dwell_s),
            either(v.intensity, parent.intensity),
            either(v.pressure_pa, parent.pressure_pa),
            either(v.press_depth_m, parent.press_depth_m),
            either(v.foci, parent.foci),
            either(v.stride, parent.stride),
            either(v.click, parent.click),
            either(v.stiffness, parent.stiffness),
            either(v.texture, parent.texture),
            either(v.grain_m, parent.grain_m)};
  if (h.foci && h.stride) {
    if (const std::string fault = stride_fault(*h.foci, *h.stride); !fault.empty()) node.fail("extras: " + fault);
  }
  if (h.clicks() && !h.press_depth_m) {
    node.fail(
        "extras: a click plays when a finger presses, so \"palpa_press_depth_m\" must say how deep that is, such as "
        "0.003");
  }
  return h;
}

bool has_palpa_extras(const Item& item) {
  return has_palpa_extras(item.json());
}

std::vector<std::string> extras_elsewhere(const Item& root) {
  constexpr std::size_t most = 8;
  std::vector<std::string> places = places_in(root.json());
  std::erase_if(places, [](const std::string& place) {
    return place.find(',') == std::string::npos && (place.starts_with("node ") || place.starts_with("mesh "));
  });
  if (places.size() > most) places.resize(most);
  std::ranges::replace(places, "", "the file");
  return places;
}

std::string explain_unknown(const std::string& key) {
  const bool flat = key.starts_with(prefix) || is_misspelt(key);
  const std::string_view bare = flat ? from_letter(from_letter(key).substr(own_name.size())) : key;
  if (flat && bare.empty()) return "did you mean \"palpa\"?";
  const std::string meant = key_like(bare);
  if (meant.empty()) return fmt::format("known are {}", fmt::join(keys, ", "));
  const std::string whole = fmt::format("{}{}", prefix, meant);  // within an object "palpa", it is unknown
  return fmt::format("did you mean \"{}\"?", flat && whole != key ? whole : meant);
}

}  // namespace palpa::geometry::gltf
