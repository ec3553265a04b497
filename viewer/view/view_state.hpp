// What a view shows and from where, as plain values. Panels, mouse, keys and options write it, the renderer reads it,
// and it is remembered between runs. A Picture is what there is to see; this is how it is seen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <optional>

#include "base/math.hpp"
#include "base/words.hpp"
#include "viewer/view/fineness.hpp"
#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {

/// Kinds of things in a picture, each shown or hidden as a whole.
enum class Layer {
  solids,
  edges,  ///< of the solids
  skin,   ///< the surface of the finger or hand
  points,
  contacts,
  sections,  ///< cross-section planes and principal axes
  foci,
  transducers,
  cameras,  ///< frusta
  depth,    ///< the cameras' images, inset
  slice,    ///< the field in a plane
  heat,     ///< what the finger feels, see SkinColour
  tile,     ///< the marker on top of the objects, as the participant sees it
  grid,
  legend,  ///< with axes and scale
};
inline constexpr Word<Layer> layer_words[] = {
    {"solids", Layer::solids}, {"edges", Layer::edges},       {"skin", Layer::skin},
    {"points", Layer::points}, {"contacts", Layer::contacts}, {"sections", Layer::sections},
    {"foci", Layer::foci},     {"array", Layer::transducers}, {"cameras", Layer::cameras},
    {"depth", Layer::depth},   {"slice", Layer::slice},       {"heat", Layer::heat},
    {"tile", Layer::tile},     {"grid", Layer::grid},         {"legend", Layer::legend}};
inline constexpr std::size_t layer_count = std::size(layer_words);

struct LayerState {
  bool visible = true;
  float opacity = 1;  ///< 0..1, multiplied by the layer's own opacity
  bool operator==(const LayerState&) const = default;
};

/// The layers. Those that cost time or cover others are hidden at first.
class Layers {
 public:
  Layers() { hide({Layer::sections, Layer::cameras, Layer::depth, Layer::slice, Layer::heat, Layer::tile}); }
  LayerState& operator[](Layer layer) { return states_[static_cast<std::size_t>(layer)]; }
  const LayerState& operator[](Layer layer) const { return states_[static_cast<std::size_t>(layer)]; }
  /// 0 for a hidden layer.
  float opacity(Layer layer) const { return (*this)[layer].visible ? (*this)[layer].opacity : 0; }
  bool shows(Layer layer) const { return opacity(layer) > 0; }
  void hide(std::initializer_list<Layer> layers) {
    for (const Layer layer : layers)
      (*this)[layer].visible = false;
  }
  bool operator==(const Layers&) const = default;

 private:
  std::array<LayerState, layer_count> states_{};
};

/// What colours the finger in the layer heat: the pressure, or the rates of one class of afferents.
enum class SkinColour { pressure, sa1, ra, pc };
inline constexpr Word<SkinColour> skin_colour_words[] = {
    {"pressure", SkinColour::pressure}, {"SA1", SkinColour::sa1}, {"RA", SkinColour::ra}, {"PC", SkinColour::pc}};

/// The plane in which the field is shown. Its x and y axes are columns 0 and 1 of its pose; it is centred at its pose.
struct SliceState {
  Transform T_world_slice{1.0};
  Vec2 size_m{0.06, 0.06};
  bool operator==(const SliceState&) const = default;
};

/// Which slot of the schedule is shown, and how time advances.
struct SlotTime {
  std::uint64_t slot = 0;  ///< its focus is the running one, and its drive colours the transducers
  bool playing = true;     ///< slots advance by themselves
  double slots_per_s = 4;  ///< how fast; with a dwell of 1.5 ms, real time is 667
  bool operator==(const SlotTime&) const = default;
};

struct ViewState {
  Viewpoint viewpoint;
  Layers layers;
  double explode = 0;  ///< how far convex parts are moved apart, as a share of the solid's size, 0..1
  SkinColour skin_colour = SkinColour::pressure;
  SliceState slice;
  bool slice_handles = false;  ///< drawn, because there is a hand to take them
  SlotTime time;
  std::optional<Vec3> picked;  ///< a point that the user asked about, world
  bool dark = false;
  FinePictures fine = FinePictures::automatic;
};

}  // namespace palpa::viewer
