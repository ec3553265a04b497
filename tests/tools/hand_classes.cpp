#include "hand_classes.hpp"

#include <fmt/format.h>

#include <iterator>

#include "geometry/gltf/gltf.hpp"
#include "hand_making.hpp"
#include "sensing/recording.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

struct Recorded {
  const char *folder, *scene, *assets;  ///< the scene is in the shared folder, or one of the assets
  std::uint32_t fingers;
  std::optional<double> predict_s;
  bool slides;
};
constexpr Recorded recordings[] = {
    {"flicker/one-finger-through-semi-sphere", nullptr, "semi-sphere.glb", 1, {}, false},
    {"flicker/spread-hand-leaning", "flicker/plate-35mm.glb", nullptr, 5, {}, false},
    {"flicker/two-fingers-touching", "flicker/plate.glb", nullptr, 2, {}, false},
    {"hands-unsteady/palm-back-thin", "hands-unsteady/plate-2.glb", nullptr, 1, {}, false},
    {"hands-unsteady/faint-slide", "hands-unsteady/plate-60.glb", nullptr, 1, {}, true},
    {"hands-unsteady/faint-slide", "hands-unsteady/plate-60.glb", nullptr, 1, 20e-3, true},
    {"hands-more/far-hand-one-camera", "hands-more/bigbox.glb", nullptr, 5, {}, false},
    {"hands-more/prediction-silences-a-frame", "hands-more/plate-60.glb", nullptr, 2, 20e-3, true},
};
constexpr std::uint64_t first_recording = 30000;

void recorded(RatedHand& hand, hands::Random&) {
  const Recorded& entry = recordings[(hand.seed - first_recording) % std::size(recordings)];
  hand.what = entry.folder;
  hand.recording = shared_data(entry.folder);
  const sensing::Recording recording = sensing::load_recording(hand.recording);
  hand.cameras = recording.cameras;
  hand.solids = geometry::make_solids(geometry::load_gltf(
      entry.assets ? source_file(std::string("assets/") + entry.assets) : shared_data(entry.scene)));
  hand.rate_hz = 90;
  hand.length_s = (static_cast<double>(recording.entries.size()) + 0.5) / hand.rate_hz;
  hand.predict_s = entry.predict_s;
  hand.fingers = entry.fingers;
  hand.slides = entry.slides;
  if (entry.predict_s) hand.what += ", predicted";
}

constexpr HandClass classes[] = {
    {"fist", 1000, 16, hands::fist, "fists at rest"},
    {"spread", 2000, 16, hands::spread, "spread fingers through the surface"},
    {"flat", 3000, 16, hands::flat, "flat hands; the thumb is lowest"},
    {"touching", 4000, 16, hands::touching, "fingers that touch each other"},
    {"relaxed", 5000, 16, hands::relaxed, "relaxed hands"},
    {"leaning", 6000, 16, hands::leans, "hands that lean far"},
    {"away", 32000, 16, hands::leans_away, "hands that lean away from the first camera"},
    {"odd", 7000, 18, hands::odd, "other poses, from any side"},
    {"two-people", 8000, 12, hands::two_people, "two people's hands"},
    {"thin", 9000, 16, hands::thin, "hands in a plate of 2 mm"},
    {"palm", 31000, 14, hands::palm, "flat hands; all of the palm touches"},
    {"through", 10000, 12, hands::through, "fingers through a plate of 6 to 15 mm"},
    {"back", 11000, 16, hands::back, "the back of a hand, mostly in a plate of 2 mm"},
    {"rims", 12000, 16, hands::rims, "hands at the edge of a small box"},
    {"sparse", 13000, 15, hands::sparse, "one camera, three close fingers of 24 to 32 contacts"},
    {"hover", 14000, 12, hands::hover, "0.1 to 0.2 mm above the surface, for 2 s"},
    {"touch", 15000, 18, hands::touch_and_leave, "a finger comes, stays and leaves"},
    {"landing", 16000, 12, hands::landing, "a hand comes down on several fingers"},
    {"second", 17000, 18, hands::second_finger, "a second finger comes beside one that rests"},
    {"pinch", 18000, 15, hands::pinch, "thumb and index finger come down, 44 contacts of the index finger"},
    {"taps", 19000, 15, hands::taps, "double taps at 4 to 8 Hz, 1 to 5 mm deep"},
    {"leave", 20000, 18, hands::leave, "withdrawals at 20, 100 and 300 mm/s"},
    {"leave-ahead", 21000, 18, hands::leave, "the same, predicted by 20 ms", 20e-3},
    {"slide", 22000, 15, hands::slide, "slides at 50 to 300 mm/s"},
    {"slide-ahead", 23000, 15, hands::slide, "the same, predicted by 20 ms", 20e-3},
    {"faint", 24000, 15, hands::faint, "0 to 0.2 mm deep at 200 mm/s, predicted by 20 ms", 20e-3},
    {"turning", 25000, 15, hands::turning, "fingers that turn and roll, predicted by 20 ms", 20e-3},
    {"meeting", 26000, 15, hands::meeting, "two fingers that cross, or meet and part"},
    {"above", 27000, 12, hands::above, "a finger presses, or touches lightly; cameras above"},
    {"beside", 28000, 12, hands::beside, "the same, cameras beside"},
    {"below", 29000, 12, hands::below, "the same, cameras below"},
    {"recorded", first_recording, std::size(recordings), recorded, "the shared recordings"},
};

}  // namespace

std::span<const HandClass> hand_classes() {
  // The recordings are not everywhere.
  return std::span(classes).first(std::size(classes) - (shared_data("hands-unsteady").empty() ? 1 : 0));
}

RatedHand make_hand_of(const HandClass& kind, std::uint64_t seed, std::optional<int> cameras) {
  RatedHand hand = hands::begun(seed, cameras.value_or(1 + static_cast<int>(seed % 3)));
  hand.predict_s = kind.predict_s;
  hands::Random random(seed);
  kind.make(hand, random);
  hand.what += fmt::format("; {} cameras, {:.0f} Hz", hand.cameras.size(), hand.rate_hz);
  return hand;
}

}  // namespace palpa::test
