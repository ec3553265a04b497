#include "setup/files/voice_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "touch/types.hpp"

namespace palpa::setup {

using geometry::gltf::Item;
using geometry::gltf::Json;

double number(const Item& item, const char* key, double low, double high) {
  const auto found = item.json().find(key);
  if (found == item.json().end()) item.fail(fmt::format("\"{}\" is missing", key));
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  if (!(value >= low && value <= high)) item.fail(fmt::format("\"{}\" must be a number in {} to {}", key, low, high));
  return value;
}

Vec3 read_place(const Item& item, const Json& value, bool or_null) {
  constexpr double farthest_m = 1e6;
  Vec3 place(0);
  bool whole = value.is_array() && value.size() == 3;
  for (int axis = 0; whole && axis < 3; ++axis) {
    const Json& metres = value[static_cast<std::size_t>(axis)];
    whole = metres.is_number() && std::abs(metres.get<double>()) < farthest_m;
    if (whole) place[axis] = metres.get<float>();
  }
  if (!whole)
    item.fail(fmt::format("\"foci_m\" must be places of three numbers in metres{}", or_null ? ", or null" : ""));
  return place;
}

const Json& list_of_foci(const Item& item) {
  const Json* foci = item.array("foci_m");
  if (!foci || foci->empty() || foci->size() > touch::max_foci)
    item.fail(fmt::format("\"foci_m\" must be a list of 1 to {} foci", touch::max_foci));
  return *foci;
}

Order read_order(const Item& item) {
  const Json* slots = item.array("order");
  if (!slots || slots->empty()) item.fail("\"order\" is missing");
  Order order;
  const auto add = [&](const Json& focus) {
    const std::uint64_t number = focus.is_number_unsigned() ? focus.get<std::uint64_t>() : touch::max_foci;
    if (number >= touch::max_foci)
      item.fail(fmt::format("\"order\" must be numbers of foci below {}", touch::max_foci));
    order.foci.push_back(static_cast<std::uint32_t>(number));
  };
  order.lists = slots->front().is_array();
  if (order.lists) order.foci_per_slot = static_cast<std::uint32_t>(slots->front().size());
  for (const Json& slot : *slots) {
    if (!order.lists) {
      add(slot);
      continue;
    }
    if (!slot.is_array() || slot.empty() || slot.size() != order.foci_per_slot)
      item.fail("the lists in \"order\" must be equally long and not empty");
    for (const Json& focus : slot)
      add(focus);
  }
  return order;
}

}  // namespace palpa::setup
