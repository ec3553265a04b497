#include <array>
#include <string_view>

#include "assets/generators/hand.hpp"
#include "base/toml.hpp"

namespace palpa::assets {
namespace {

struct Angle {
  std::string_view key;
  double* value;
};

/// In radians; angles that the file does not name keep their values.
void read_digit(TomlTable& root, std::string_view name, const std::array<Angle, 4>& angles) {
  auto digit = root.table(name);
  if (!digit) return;
  for (const Angle& angle : angles) {
    const bool is_abduction = angle.key == "abduction";
    *angle.value = digit->number_or(angle.key, *angle.value, is_abduction ? -0.7 : -0.5, is_abduction ? 0.9 : 2.0);
  }
  digit->done();
}

}  // namespace

HandPose read_hand_pose(const std::filesystem::path& file) {
  TomlTable root = TomlTable::load(file, "a hand's pose");
  HandPose pose;
  ThumbPose& t = pose.thumb;
  read_digit(root, "thumb", {{{"cmc", &t.cmc}, {"mcp", &t.mcp}, {"ip", &t.ip}, {"abduction", &t.abduction}}});
  constexpr std::array<std::string_view, 4> names{"index", "middle", "ring", "little"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    FingerPose& f = pose.fingers[i];
    read_digit(root, names[i], {{{"mcp", &f.mcp}, {"pip", &f.pip}, {"dip", &f.dip}, {"abduction", &f.abduction}}});
  }
  root.done();
  return pose;
}

}  // namespace palpa::assets
