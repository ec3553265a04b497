#include "viewer/panel_data/option_words.hpp"

#include <algorithm>
#include <system_error>

#include "base/units.hpp"

namespace palpa::viewer {
namespace {

struct Entry {
  const char* name;
  const char* label;
  const char* unit = "";
  FieldKind kind = FieldKind::plain;
  const char* about = nullptr;  ///< if the help of the command line is not clear in a panel
};

constexpr Entry entries[] = {
    {"--scene", "object", "", FieldKind::object},
    {"--gltf-scene", "scene in the file"},
    {"--source", "frames come from", "", FieldKind::source,
     "Where depth frames come from: a fingertip that is made up, a recording, or cameras, such as v4l2:/dev/video0"},
    {"--allow-outside", "files outside"},
    {"--hold", "hold", "ms"},
    {"--ceiling", "amplitude ceiling"},
    {"--ramp", "ramp", "ms"},
    {"--noise-free", "without noise"},
    {"--keep-boards", "boards count as skin"},
    {"--events", "write events to", "", FieldKind::new_file,
     "Writes a line of JSON when a finger touches, moves on, presses or releases"},
    {"--event-move", "event's move", "mm"},
    {"--link", "link", "", FieldKind::link,
     "Where drives go: null (nowhere), record: and a file, foci:udp: with host and port, or a board: openmpd: with "
     "serial numbers, sonicsurface: with a serial port, autd3: with a server's host and port"},
    {"--board-files", "boards' own files", "", FieldKind::folder},
    {"--every-frame", "process every frame"},
    {"--record", "record to", "", FieldKind::new_folder,
     "Writes every depth frame into a new folder, which can be played as a recording"},
    {"--overwrite", "replace a recording"},
    {"--surface", "surface"},
    {"--parts", "most parts"},
    {"--internal-faces", "cuts between parts"},
    {"--rig", "rig", "", FieldKind::rig},
    {"--layout", "array", "", FieldKind::layout},
    {"--delta", "shell", "mm"},
    {"--finger-gap", "finger gap", "mm"},
    {"--min-points", "fewest contacts"},
    {"--finger-width", "widest finger", "mm"},
    {"--cluster", "clustered skin"},
    {"--foci", "foci of a finger"},
    {"--spacing", "spacing of foci"},
    {"--stride", "stride, in foci"},
    {"--dwell", "dwell", "ms"},
    {"--method", "method"},
    {"--modulation", "what is modulated"},
    {"--modulation-frequency", "modulation", "Hz"},
    {"--tune", "tune for the skin"},
    {"--spot", "spot width", "mm"},
    {"--amplitude", "amplitude"},
    {"--solver", "solver"},
    {"--constraint", "constraint"},
    {"--pressure", "pressure at foci", "Pa"},
    {"--directivity", "directivity"},
    {"--temperature", "air, degrees C"},
    {"--sound-speed", "speed of sound", "m/s"},
    {"--frequency", "tone", "kHz"},
    {"--axes", "axes"},
    {"--smoothing", "smoothing"},
    {"--hysteresis", "hysteresis"},
    {"--predict", "foci ahead of fingers"},
    {"--predict-latency", "latency to predict", "ms"},
    {"--gpu", "GPU"},
    {"--backend", "computes on"},
    {"--seed", "random seed"},
    {"--validation", "checks of Vulkan"},
    {"--frames", "end after frames"},
    {"--stats", "measurements printed"},
    {"--json", "results as JSON", "", FieldKind::new_file},
    {"--quiet", "print nothing"},
    {"--log-level", "least message"},
};

}  // namespace

OptionWords words_of(const setup::OptionInfo& info) {
  const auto* const known = std::ranges::find(entries, info.name, &Entry::name);
  if (known != std::end(entries)) {
    const std::string about = known->about != nullptr ? known->about : info.help;
    return {info.name, known->label, known->unit, about, known->kind};
  }
  std::string label = info.name.substr(std::min<std::size_t>(2, info.name.size()));
  std::ranges::replace(label, '-', ' ');
  return {info.name, label, "", info.help, FieldKind::plain};
}

std::string label_of(const OptionWords& words) {
  return words.unit.empty() ? words.label : words.label + ", " + words.unit;
}

std::string shown_default(const setup::OptionInfo& info) {
  if (!info.initial.empty()) return info.initial;
  return info.name == "--scene" ? "none yet" : "none";
}

std::string with_unit(const std::string& text, const OptionWords& words) {
  if (words.unit.empty()) return text;
  return parse_number(text) ? text + words.unit : text;
}

}  // namespace palpa::viewer
