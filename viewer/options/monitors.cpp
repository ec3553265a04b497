#include "viewer/options/monitors.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpa::viewer {
namespace {

int right_of(const WindowPlace& place) {
  return place.x + static_cast<int>(place.width);
}

int bottom_of(const WindowPlace& place) {
  return place.y + static_cast<int>(place.height);
}

bool overlap(const WindowPlace& a, const WindowPlace& b) {
  return a.x < right_of(b) && b.x < right_of(a) && a.y < bottom_of(b) && b.y < bottom_of(a);
}

bool inside(const WindowPlace& area, const WindowPlace& place) {
  return place.x >= area.x && place.y >= area.y && right_of(place) <= right_of(area) &&
         bottom_of(place) <= bottom_of(area);
}

}  // namespace

std::size_t chosen_monitor(const std::vector<std::string>& names, const std::string& wanted) {
  if (wanted.empty()) return names.empty() ? 0 : names.size() - 1;
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string number = std::to_string(i + 1), &name = names[i];
    if (wanted == number || wanted == name || wanted == name.substr(0, name.rfind(' '))) return i;
    if (i > 0) all += ", ";
    all.append(number).append(" (").append(name).append(")");
  }
  throw bad_usage("--monitor: unknown monitor '" + wanted + "'; give one of " + all);
}

std::optional<TwoPlaces> side_by_side(const WindowPlace& area, const WindowPlace& panel, const WindowPlace& picture,
                                      bool sized) {
  if (!overlap(panel, picture) && inside(area, panel) && inside(area, picture)) return std::nullopt;
  TwoPlaces places{panel, picture};
  std::uint32_t& left = places.left.width;
  if (left + picture.width > area.width && !sized) {
    left = std::min(left, area.width / 2);
    const double scale = std::min(1.0, static_cast<double>(area.width - left) / picture.width);
    places.right.width = static_cast<std::uint32_t>(std::lround(picture.width * scale));
    places.right.height = static_cast<std::uint32_t>(std::lround(picture.height * scale));
  }
  if (left + places.right.width > area.width) {
    const std::uint32_t rest = area.width - std::min(area.width, places.right.width);
    left = std::min(left, std::max(rest, area.width / 4));
  }
  places.left.height = std::min(places.left.height, area.height);
  places.left.x = area.x;
  places.left.y = places.right.y = area.y;
  places.right.x = area.x + static_cast<int>(left);
  return places;
}

}  // namespace palpa::viewer
