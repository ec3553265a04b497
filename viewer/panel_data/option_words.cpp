#include "viewer/panel_data/option_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "array/layouts/board_types.hpp"
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
     "Where drives go: null (nowhere), record: and a file, foci:udp: with host and port, or a board: "},
    {"--board-files", "boards' own files", "", FieldKind::folder},
    {"--steps", "steps between drives"},
    {"--every-frame", "process every frame"},
    {"--record", "record to", "", FieldKind::new_folder,
     "Writes every depth frame into a new folder, which can be played as a recording"},
    {"--overwrite", "replace a recording"},
    {"--osc", "messages by OSC", "", FieldKind::plain,
     "Takes gain, mute, and poses and feel of objects from other programs, by OSC: a number such as 9000 for "
     "those of this machine, or an address and a number, such as 0.0.0.0:9000"},
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
    {"--modulation", "what is modulated"},
    {"--modulation-frequency", "modulation", "Hz"},
    {"--tune", "tune for the skin"},
    {"--spot", "spot width", "mm"},
    {"--pressure", "pressure at foci", "Pa"},
    {"--temperature", "air, degrees C"},
    {"--sound-speed", "speed of sound", "m/s"},
    {"--frequency", "tone", "kHz"},
    {"--predict", "foci ahead of fingers"},
    {"--predict-latency", "latency to predict", "ms"},
    {"--gpu", "GPU"},
    {"--backend", "computes on"},
    {"--seed", "random seed"},
    {"--validation", "checks of Vulkan"},
    {"--frames", "end after frames"},
    {"--stats", "measurements printed"},
    {"--reload", "read the object again", "", FieldKind::plain,
     "Reads a saved object again while it runs, which the viewer does in any case"},
    {"--json", "results as JSON", "", FieldKind::new_file},
    {"--quiet", "print nothing"},
    {"--log-level", "least message"},
};

struct Meaning {
  const char *option, *word, *meaning;
};

constexpr Meaning meanings[] = {
    {"--surface", "mesh", "the mesh itself"},
    {"--surface", "parts", "convex parts that are cut from the mesh"},
    {"--internal-faces", "drop", "cuts between parts are no surface"},
    {"--internal-faces", "keep", "cuts between parts are surface, too"},
    {"--cluster", "contacts", "skin in the shell under the surface"},
    {"--cluster", "inside", "all skin inside the solid"},
    {"--spacing", "angle", "equal angles around the middle"},
    {"--spacing", "arc", "equal lengths along the outline"},
    {"--method", "cross-section", "foci around the finger's cross-section, one after the other"},
    {"--method", "single-focus", "one focus in the middle of the contacts, modulated"},
    {"--method", "ellipse", "foci on an ellipse that fits the contacts, one after the other"},
    {"--method", "multi-focus", "all foci of the cross-section at once, modulated"},
    {"--modulation", "pressure-sine", "the pressure that skin feels is a sine in time"},
    {"--modulation", "amplitude-sine", "the transducers' amplitude is a sine in time"},
    {"--amplitude", "distance", "in proportion to a transducer's distance from the focus"},
    {"--amplitude", "uniform", "the same of every transducer"},
    {"--solver", "naive", "adds up the drives of the single foci, and is the fastest"},
    {"--solver", "gs-pat", "makes all foci equally loud"},
    {"--solver", "greedy", "sets one transducer after the other, only by phases"},
    {"--solver", "loudest", "makes the weakest focus as loud as possible"},
    {"--solver", "eigenvalue", "as in Long's work, to compare: even only where amplitudes are in proportion"},
    {"--solver", "back-propagation", "as in Marzo's work, to compare: loud, but not even"},
    {"--solver", "adjoint", "uses a finger's mesh, which a live run does not have"},
    {"--constraint", "normalise", "in proportion, so that the largest amplitude is 1"},
    {"--constraint", "uniform", "every amplitude is 1, and only phases differ"},
    {"--constraint", "clamp", "amplitudes above 1 become 1"},
    {"--directivity", "omni", "the same in all directions"},
    {"--directivity", "piston", "that of a circular piston in a wall"},
    {"--directivity", "t4010a1", "as measured for the transducer of AUTD3"},
    {"--axes", "steady", "turned as little as possible from frame to frame"},
    {"--axes", "covariance", "each frame's own principal axes"},
    {"--smoothing", "one-euro", "foci that hardly move are smoothed most"},
    {"--smoothing", "none", "foci are as each frame has them"},
    {"--transfer", "free", "the sound of free air, as if no finger were there"},
    {"--transfer", "finger", "the sound on a mesh of the finger, which follows the hand"},
    {"--steps", "on", "boards that can go from drive to drive in steps, which is quieter"},
    {"--steps", "off", "drives change at once"},
    {"--hysteresis", "on", "a finger stays one until the evidence against it is strong"},
    {"--hysteresis", "off", "each frame decides for itself what a finger is"},
    {"--predict", "auto", "foci sound where the finger will be at that time"},
    {"--predict", "off", "foci sound where the finger was seen"},
    {"--backend", "auto", "a GPU if there is one, otherwise the processor"},
    {"--backend", "gpu", "a GPU, or a driver that does its work"},
    {"--backend", "cpu", "the processor, with the same results"},
    {"--validation", "off", "the driver trusts palpa"},
    {"--validation", "core", "checks that calls of Vulkan are right"},
    {"--validation", "sync", "checks also that commands wait for each other"},
    {"--validation", "gpu-assisted", "checks also what kernels read and write, and is slow"},
};

/// "autd3: with a server's host and port, ..."
std::string boards() {
  std::string all;
  for (const array::BoardType& type : array::board_types())
    all += fmt::format("{}{}: with {}", all.empty() ? "" : ", ", type.name, type.link_words);
  return all;
}

}  // namespace

OptionWords words_of(const line::OptionInfo& info) {
  const auto* const known = std::ranges::find(entries, info.name, &Entry::name);
  if (known != std::end(entries)) {
    std::string about = known->about != nullptr ? known->about : info.help;
    if (known->kind == FieldKind::link) about += boards();
    return {info.name, known->label, known->unit, about, known->kind};
  }
  std::string label = info.name.substr(std::min<std::size_t>(2, info.name.size()));
  std::ranges::replace(label, '-', ' ');
  return {info.name, label, "", info.help, FieldKind::plain};
}

std::string label_of(const OptionWords& words) {
  return words.unit.empty() ? words.label : words.label + ", " + words.unit;
}

std::string shown_default(const line::OptionInfo& info) {
  if (!info.initial.empty()) return info.initial;
  return info.name == "--scene" ? "none yet" : "none";
}

std::string with_unit(const std::string& text, const OptionWords& words) {
  if (words.unit.empty()) return text;
  return parse_number(text) ? text + words.unit : text;
}

std::string meaning_of(const std::string& option, const std::string& word) {
  const auto* const found = std::ranges::find_if(
      meanings, [&](const Meaning& entry) { return option == entry.option && word == entry.word; });
  return found == std::end(meanings) ? std::string() : found->meaning;
}

}  // namespace palpa::viewer
