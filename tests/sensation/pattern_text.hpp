// Small patterns as text, for tests.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace palpa::test {

inline std::string f64(double value) {
  return fmt::format(R"({{"type":"f64","value":{}}})", value);
}
inline std::string param(std::string_view name) {
  return fmt::format(R"({{"type":"param","value":"{}"}})", name);
}
inline std::string transition_text(std::string_view name) {
  return fmt::format(R"("transition":{{"name":"{}","params":{{}}}})", name);
}
inline std::string coords(double x, double y, double z, std::string_view transition = "linear") {
  return fmt::format(R"(,"coords":{{"coords":{{"x":{},"y":{},"z":{}}},{}}})", x, y, z, transition_text(transition));
}
inline std::string intensity(const std::string& number, std::string_view transition = "linear") {
  return fmt::format(R"(,"intensity":{{"intensity":{{"name":"constant","params":{{"value":{}}}}},{}}})", number,
                     transition_text(transition));
}
inline std::string brush(std::string_view name, const std::string& params, std::string_view transition = "linear") {
  return fmt::format(R"(,"brush":{{"brush":{{"name":"{}","params":{{{}}}}},{}}})", name, params,
                     transition_text(transition));
}
inline std::string circle(const std::string& radius, double am_hz = 0, std::string_view transition = "linear") {
  return brush("circle", fmt::format(R"("radius":{},"am_freq":{})", radius, f64(am_hz)), transition);
}
inline std::string line(double length, double thickness, double rotation, double am_hz) {
  return brush("line", fmt::format(R"("length":{},"thickness":{},"rotation":{},"am_freq":{})", f64(length),
                                   f64(thickness), f64(rotation), f64(am_hz)));
}
inline std::string jump(std::string_view parameter, std::string_view is, double value, double to_ms) {
  return fmt::format(
      R"({{"condition":{{"parameter":"{}","operator":{{"name":"{}","params":{{}}}},"value":{}}},"jump_to":{}}})",
      parameter, is, value, to_ms);
}
/// `parts`: texts of coords(), brush and intensity; `jumps`: those of jump(), joined by commas.
inline std::string key(std::string_view type, double time_ms, const std::string& parts = "",
                       const std::string& jumps = "") {
  const std::string cjumps = type == "stop" ? "" : fmt::format(R"(,"cjumps":[{}])", jumps);
  return fmt::format(R"({{"type":"{}","time":{}{}{}}})", type, time_ms, parts, cjumps);
}

struct PatternText {
  std::string keyframes;
  std::string revision = "0.1.0-alpha.3";
  std::string definitions;  ///< "a":{"default":0,"step":1}
  std::string translate = fmt::format(R"({{"x":{},"y":{},"z":{}}})", f64(0), f64(0), f64(200));
  std::string scale = fmt::format(R"({{"x":{},"y":{},"z":{}}})", f64(1), f64(1), f64(1));
  std::string rotation = f64(0), factor = f64(1), speed = f64(1);
  std::string more;  ///< further keys

  std::string text() const {
    return fmt::format(
        R"({{"$DATA_FORMAT":"MidAirHapticsAnimationFileFormat","$REVISION":"{}","name":"test","keyframes":[{}],)"
        R"("pattern_transform":{{"geometric_transforms":{{"translate":{},"rotation":{},"scale":{}}},)"
        R"("intensity_factor":{},"playback_speed":{}}},"user_parameter_definitions":{{{}}}{}}})",
        revision, keyframes, translate, rotation, scale, factor, speed, definitions, more);
  }
};

}  // namespace palpa::test
