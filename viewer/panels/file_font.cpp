#include "viewer/panels/file_font.hpp"

#include <dlfcn.h>
#include <imgui.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

/// Where distributions have them.
constexpr const char* default_places[] = {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
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

/// The bytes of the file; empty if it cannot be read.
std::string bytes_of(const std::string& file) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(file, fault)) return {};
  try {
    return read_file(file, most_bytes);
  } catch (const Error&) {
    return {};
  }
}

/// A function of the library, with the type that `fontconfig/fontconfig.h` gives it.
template <typename Function>
Function* function_of(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

}  // namespace

std::string fontconfig_file() {
  struct Pattern;
  void* const library = dlopen("libfontconfig.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return {};
  auto* const init = function_of<int()>(library, "FcInit");
  auto* const pattern_of = function_of<Pattern*(const char*)>(library, "FcNameParse");
  auto* const substitute = function_of<int(void*, Pattern*, int)>(library, "FcConfigSubstitute");
  auto* const complete = function_of<void(Pattern*)>(library, "FcDefaultSubstitute");
  auto* const nearest = function_of<Pattern*(void*, Pattern*, int*)>(library, "FcFontMatch");
  auto* const get = function_of<int(Pattern*, const char*, int, char**)>(library, "FcPatternGetString");
  auto* const destroy = function_of<void(Pattern*)>(library, "FcPatternDestroy");
  std::string file;
  const bool whole = init && pattern_of && substitute && complete && nearest && get && destroy;
  Pattern* const wanted = whole && init() ? pattern_of("sans:fontformat=TrueType") : nullptr;
  if (wanted != nullptr) {
    constexpr int for_match = 0;
    substitute(nullptr, wanted, for_match);
    complete(wanted);
    int result = 0;
    if (Pattern* const found = nearest(nullptr, wanted, &result)) {
      char* name = nullptr;
      if (get(found, "file", 0, &name) == 0 && name != nullptr) file = name;
      destroy(found);
    }
    destroy(wanted);
  }
  return file;  // the library stays loaded: other libraries may use it, too
}

std::string system_font() {
  for (const char* place : default_places) {
    if (std::string bytes = bytes_of(place); !bytes.empty()) return bytes;
  }
  return bytes_of(fontconfig_file());
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
  for (const double scale : font_scales) {
    atlas.AddFontFromMemoryTTF(ttf.data(), static_cast<int>(ttf.size()),
                               static_cast<float>(std::round(text_height * ratio * scale)), &config, ranges);
  }
  if (!atlas.Build()) return std::nullopt;
  return glyphs_of(atlas);
}

}  // namespace palpa::viewer
