#include "viewer/desk/word_meanings.hpp"

#include <algorithm>
#include <iterator>

namespace palpa::viewer {
namespace {

struct Entry {
  const char *option, *word, *meaning;
};

constexpr Entry entries[] = {
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

}  // namespace

std::string meaning_of(const std::string& option, const std::string& word) {
  const auto* const found =
      std::ranges::find_if(entries, [&](const Entry& entry) { return option == entry.option && word == entry.word; });
  return found == std::end(entries) ? std::string() : found->meaning;
}

}  // namespace palpa::viewer
