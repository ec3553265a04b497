#include "viewer/panels/file_font.hpp"

#include <imgui.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

/// Where distributions have them.
constexpr const char* usual_places[] = {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                        "/usr/share/fonts/noto/NotoSans-Regular.ttf",
                                        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                        "/usr/share/fonts/TTF/DejaVuSans.ttf",
                                        "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                                        "/usr/share/fonts/liberation-sans/LiberationSans-Regular.ttf",
                                        "/usr/share/fonts/liberation/LiberationSans-Regular.ttf"};
constexpr std::uint64_t most_bytes = 8U << 20;

/// Latin, and what the strokes have besides ASCII.
constexpr ImWchar ranges[] = {0x20, 0xff, 0x3c0, 0x3c0, 0x2013, 0x2014, 0x2192, 0x2192, 0x2212, 0x2212, 0};

}  // namespace

std::string system_font() {
  for (const char* place : usual_places) {
    std::error_code fault;
    if (!std::filesystem::is_regular_file(place, fault)) continue;
    try {
      return read_file(place, most_bytes);
    } catch (const Error&) {  // the next one
    }
  }
  return {};
}

std::optional<Glyphs> make_file_font(ImFontAtlas& atlas, std::string& ttf, double ratio) {
  constexpr std::string_view magic("\0\1\0\0", 4);
  if (!ttf.starts_with(magic)) return std::nullopt;
  atlas.Clear();
  atlas.Flags |= ImFontAtlasFlags_NoMouseCursors | ImFontAtlasFlags_NoBakedLines;
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;
  config.OversampleH = config.OversampleV = 1;
  config.PixelSnapH = true;
  atlas.AddFontFromMemoryTTF(ttf.data(), static_cast<int>(ttf.size()),
                             static_cast<float>(std::round(text_height * ratio)), &config, ranges);
  if (!atlas.Build()) return std::nullopt;
  return glyphs_of(atlas);
}

}  // namespace palpa::viewer
