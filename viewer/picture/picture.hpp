// What a picture shows, as plain values: the renderer's whole input besides the viewpoint. Contains no Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "array/layouts/layout.hpp"
#include "array/schedule.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "drawing/colour.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "touch/methods/method.hpp"
#include "touch/types.hpp"
#include "viewer/view/frustum.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// A translucent surface in world coordinates, welded.
struct SurfaceMark {
  std::string name;
  geometry::Mesh mesh;
  std::optional<std::uint32_t> part{};     ///< index of a solid's convex part; each has its own colour
  std::vector<drawing::Colour> colours{};  ///< of the mesh's vertices, for the layer heat; else empty
  std::uint32_t solid = 0;                 ///< index of the scene's solid that it is, or is a part of
  std::string feel{};                      ///< see feel_of
  std::optional<Vec3> name_at{};           ///< in a drawn picture: above the solid, for its name
};

/// "clicks, spring, texture": what a finger feels of a solid besides its shape, or some of these; may be empty.
std::string feel_of(const geometry::Haptics& haptics);

/// A skin point in a solid's shell, drawn in its finger's colour.
struct ContactMark {
  glm::vec3 position{};
  std::optional<std::uint32_t> finger;  ///< nullopt: its cluster is too small to be a finger
};

/// One entry of a finger's order. An empty sector plays another sector's focus and has no mark of its own.
struct FocusMark {
  glm::vec3 position{};
  std::uint32_t number = 0;  ///< its place in the order, from 1
  bool own = true;           ///< false: an empty sector's slot
};

/// A finger's cross-section: the plane of its contacts, and its principal axes.
struct SectionMark {
  glm::vec3 centre{};
  std::array<glm::vec3, 3> axes{};  ///< the longer and the shorter in the plane, then its normal; unit vectors
  glm::vec2 reach{};                ///< along the first two: two standard deviations, metres
};
/// Where the drawn axis 0, 1 or 2 ends: beyond the plane's rim, so that its name has room.
glm::vec3 section_tip(const SectionMark& section, std::size_t axis);

struct FingerMarks {
  std::string solid;  ///< what it touches
  std::uint32_t contacts = 0;
  std::vector<FocusMark> foci;  ///< in playing order; a line joins them in this order
  /// If the foci play elsewhere, ahead of the finger: the places where they were seen, in the order of their angle. An
  /// outline joins them, and a line leads from its middle to that of the foci.
  std::vector<glm::vec3> seen;
  /// Index into `foci` of the focus that sounds now, highlighted.
  std::optional<std::uint32_t> running;
  bool together = false;               ///< all of them sound now
  std::optional<SectionMark> section;  ///< nullopt for a finger that is a single point
  /// Not empty: the marks belong to a sensation, which has no finger. The legend has these words, and the foci are
  /// where the focus was last: without numbers, and the line through them is open.
  std::string sensation{};
};

/// One spectral line of what skin feels, as a share of the mean pressure.
struct SpectrumMark {
  double frequency_hz = 0;
  double around = 0;  ///< amplitude around the perimeter (acoustics::Line)
  double felt = 0;    ///< the same, weighted by the skin's sensitivity
};

struct TransducerMark {
  glm::vec3 position{}, axis{};
  float amplitude = 0, phase = 0;  ///< of its drive; brightness and hue
};

/// A transducer board: corners in order around it.
using BoardMark = std::array<glm::vec3, 4>;

struct CameraMark {
  std::string name;
  glm::vec3 apex{};
  std::array<glm::vec3, 4> corners{};  ///< the image's corners, some way in front of the apex
  Frustum frustum{};                   ///< what it sees
};

/// How a layer of sound compares with what sounds now.
enum class Standing { fresh, stale, failed };

/// What the colours of a layer mean, from 0 to `most`.
struct ColourBar {
  Layer layer = Layer::slice;
  std::string title;  ///< with its unit
  double most = 1;    ///< 0: not known yet, only the title is drawn
  Standing standing = Standing::fresh;
  std::string progress{};  ///< of a stale layer: progress of the next result, ", 40 %"; may be empty
};

/// A flat image in the world.
struct ImageMark {
  Layer layer = Layer::depth;
  std::array<glm::vec3, 4> corners{};  ///< top left, top right, bottom right, bottom left
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  ///< rows from the top; red in the lowest byte, then green, blue and alpha
};

/// What a picture shows without its surfaces, points and images. Labels, legend, chart and bars are made from it, so it
/// stays on the host when the rest is on the device.
struct PictureNotes {
  std::string title;                ///< above the legend, may be empty
  std::string untouched;            ///< why nothing touches; empty if something does, or if nobody looked
  std::uint64_t skin_count = 0;     ///< those near the solids, including contacts; of a file, all
  std::uint64_t dropped_count = 0;  ///< points near the solids that are no skin, or float beside it
  std::vector<ContactMark> contacts;
  std::vector<FingerMarks> fingers;
  std::vector<TransducerMark> transducers;
  bool driven = false;  ///< transducers have a drive; otherwise they are drawn idle
  std::vector<CameraMark> cameras;
  std::vector<ColourBar> bars;
  std::vector<std::vector<SpectrumMark>> spectra;  ///< one per finger, drawn as a chart; or empty
};

struct Picture : PictureNotes {
  std::vector<SurfaceMark> solids;
  std::optional<std::array<glm::vec3, 4>> tile;  ///< marks the top of the solids; corners in order around it
  std::uint32_t tile_solid = 0;                  ///< the solid that has the tile
  std::optional<SurfaceMark> skin;               ///< the finger's or hand's surface, drawn faintly
  std::vector<glm::vec3> skin_points;            ///< those near the solids that are not contacts
  std::vector<glm::vec3> dropped_points;         ///< near the solids, but no skin: on boards, beside rims; faint
  float transducer_radius_m = 4.2e-3f;
  std::vector<BoardMark> boards;
  std::vector<ImageMark> images;

  /// Whether slots look different from each other.
  bool changes() const;
};

// These fill a picture from the engine's values. Each replaces only its own part.

/// Also puts a tile of 10 mm on the highest solid, in the middle of its top.
void show_solids(Picture& picture, std::span<const geometry::Solid> solids);
/// `points` in ascending order of index; those that are contacts are drawn as contacts only.
void show_touch(Picture& picture, std::span<const geometry::Solid> solids, std::span<const sensing::SkinPoint> points,
                const touch::Touch& touch);
/// Why nothing touches in the picture of show_touch: its contacts make no finger, or else what `nearest` says about the
/// nearest skin. Empty if a finger touches.
std::string why_untouched(const Picture& picture, const std::string& nearest);
/// Foci in playing order, one voice and one placement per finger of `show_touch`, in its order.
void show_schedule(Picture& picture, const array::Schedule& schedule, std::span<const touch::Placement> placements);
/// What skin feels of each finger, in the order of `show_touch`.
void show_spectra(Picture& picture, std::span<const acoustics::Spectrum> spectra);
/// Shows which focus sounds in `slot`. The counter never restarts.
void show_slot(Picture& picture, const array::Schedule& schedule, std::uint64_t slot);
/// `layout` posed in the world.
void show_array(Picture& picture, const array::Layout& layout);
/// The drive of the transducers that show_array put there, in the same order.
void show_drive(Picture& picture, std::span<const array::TransducerDrive> drive);
/// Frusta 80 mm long.
void show_cameras(Picture& picture, std::span<const sensing::Camera> cameras);
/// One image for each camera of show_cameras, at the end of its frustum. Nearer is lighter, and no data is a shade.
/// Images are coarser than the frames, so that a live view stays quick.
void show_depth(Picture& picture, std::span<const sensing::Camera> cameras,
                std::span<const sensing::DepthFrame> frames);

/// How far each surface moves when solids are taken apart; zero for a solid that is whole. Parts move away from their
/// solid's middle, those at its ends by about its size.
std::vector<Vec3> apart(std::span<const SurfaceMark> solids);

/// What the view should show.
enum class Extent {
  touch,    ///< close up: fingers' contacts and foci; objects if nothing touches
  objects,  ///< solids, contacts, and the skin up to 3 cm around them
  all,      ///< everything, including array and cameras
};
/// `state` says how far parts are apart (`explode`) and whether cameras are shown.
Box extent(const Picture& picture, Extent extent, const ViewState& state = {});

}  // namespace palpa::viewer
