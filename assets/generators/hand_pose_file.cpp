#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "assets/generators/hand.hpp"
#include "base/error.hpp"

namespace palpa::assets {
namespace {

struct Angle {
  const char* key;
  double* value;
};

void read_angle(const std::string& file, const std::string& where, const toml::node& node, double& angle) {
  const bool is_abduction = where.ends_with(".abduction");
  const double least = is_abduction ? -0.7 : -0.5, most = is_abduction ? 0.9 : 2.0;
  const std::optional<double> value = node.value<double>();
  if (!node.is_number() || !value || !(*value >= least && *value <= most))
    throw bad_input(
        file, where + " must be an angle in radians from " + std::string(is_abduction ? "-0.7 to 0.9" : "-0.5 to 2"));
  angle = *value;
}

void read_digit(const std::string& file, const std::string& name, const toml::node& node,
                const std::array<Angle, 4>& angles) {
  const toml::table* table = node.as_table();
  if (table == nullptr) throw bad_input(file, name + " must be a table of angles");
  for (const auto& [key, value] : *table) {
    bool known = false;
    for (const Angle& angle : angles) {
      if (key.str() != angle.key) continue;
      read_angle(file, name + '.' + angle.key, value, *angle.value);
      known = true;
    }
    if (!known)
      throw bad_input(file, name + '.' + std::string(key.str()) + " is unknown; known are " + angles[0].key + ", " +
                                angles[1].key + ", " + angles[2].key + " and " + angles[3].key);
  }
}

}  // namespace

HandPose read_hand_pose(const std::filesystem::path& file) {
  const std::string name = file.string();
  toml::table root;
  try {
    root = toml::parse_file(name);
  } catch (const toml::parse_error& error) {
    throw bad_input(name,
                    std::string(error.description()) + " (line " + std::to_string(error.source().begin.line) + ")");
  }
  HandPose pose;
  for (const auto& [key, node] : root) {
    constexpr std::array<std::string_view, 4> kNames{"index", "middle", "ring", "little"};
    if (key.str() == "thumb") {
      ThumbPose& t = pose.thumb;
      read_digit(name, "thumb", node, {{{"cmc", &t.cmc}, {"mcp", &t.mcp}, {"ip", &t.ip}, {"abduction", &t.abduction}}});
      continue;
    }
    const auto found = std::find(kNames.begin(), kNames.end(), key.str());
    if (found == kNames.end())
      throw bad_input(name,
                      '"' + std::string(key.str()) + "\" is unknown; known are thumb, index, middle, ring and little");
    FingerPose& f = pose.fingers[found - kNames.begin()];
    read_digit(name, std::string(*found), node,
               {{{"mcp", &f.mcp}, {"pip", &f.pip}, {"dip", &f.dip}, {"abduction", &f.abduction}}});
  }
  return pose;
}

}  // namespace palpa::assets
