// What a view shows and from where, as plain values: panels, mouse, keys and options write it, the renderer reads it,
// and it is remembered from one day to the next. What there is to be seen is a Picture; this says how it is looked at.
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
  heat,     ///< the pressure on the finger
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
  float opacity = 1;  ///< 0..1, times what the layer has by itself
  bool operator==(const LayerState&) const = default;
};

/// The layers. What costs time or covers others is hidden at first.
class Layers {
 public:
  Layers() { hide({Layer::sections, Layer::cameras, Layer::depth, Layer::slice, Layer::heat, Layer::tile}); }
  LayerState& operator[](Layer layer) { return states_[static_cast<std::size_t>(layer)]; }
  const LayerState& operator[](Layer layer) const { return states_[static_cast<std::size_t>(layer)]; }
  /// 0 for a layer that is hidden.
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

/// The plane in which the field is shown. Its x and y axes are columns 0 and 1 of its pose; it is centred there.
struct SliceState {
  Transform T_world_slice{1.0};
  Vec2 size_m{0.06, 0.06};
  bool operator==(const SliceState&) const = default;
};

/// A focus of a finger: indices into Picture::fingers and its FingerMarks::foci.
struct FocusChoice {
  std::uint32_t finger = 0, focus = 0;
  bool operator==(const FocusChoice&) const = default;
};

/// Which slot of the schedule is shown, and how time goes on.
struct SlotTime {
  std::uint64_t slot = 0;  ///< its focus runs, its drive colours the transducers
  bool playing = true;     ///< slots go on by themselves
  double slots_per_s = 4;  ///< how fast; a dwell of 1.5 ms is 667 of them in real time
  bool operator==(const SlotTime&) const = default;
};

struct ViewState {
  Viewpoint viewpoint;
  Layers layers;
  double explode = 0;  ///< how far convex parts are moved apart, 0..1: by that share of the solid's size
  SliceState slice;
  bool slice_handles = false;  ///< drawn: there is a hand to take them
  SlotTime time;
  std::optional<FocusChoice> chosen;  ///< a focus to be told apart from all others; nothing: only the one that runs
  std::optional<Vec3> picked;         ///< a point that was asked about, world
  bool dark = false;
  FinePictures fine = FinePictures::automatic;
};

}  // namespace palpa::viewer
