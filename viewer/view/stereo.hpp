// What a participant sees on a screen that stands in the workspace: each eye looks through the screen as through a
// window, so that things stand where they are felt; and two eyes' pictures become one, as the screen tells them apart.
#pragma once

#include <cstdint>

#include "base/words.hpp"
#include "drawing/png.hpp"
#include "sensing/rig.hpp"
#include "viewer/view/frustum.hpp"

namespace palpa::viewer {

enum class Stereo {
  none,          ///< one eye, between the two
  side_by_side,  ///< left and right half, each squeezed to half the width
  top_bottom,    ///< the left eye's above
  anaglyph,      ///< red for the left eye, cyan for the right
  columns,       ///< interleaved for a parallax barrier of upright slits
  rows,          ///< interleaved by rows
};
inline constexpr Word<Stereo> stereo_words[] = {
    {"none", Stereo::none},         {"side-by-side", Stereo::side_by_side}, {"top-bottom", Stereo::top_bottom},
    {"anaglyph", Stereo::anaglyph}, {"columns", Stereo::columns},           {"rows", Stereo::rows}};

/// Whether the screen's own eye, and so whoever looks, is before it.
bool in_front(const sensing::Screen& screen);
/// What the eye sees through the screen, whose picture shows just that. Throws bad_usage where the eye is not before
/// the screen.
Frustum onto(const sensing::Screen& screen, const Vec3& eye);

struct Eyes {
  Vec3 left{}, right{};  ///< world
};
/// Side by side along the screen's x, `apart_m` from each other; the screen's eye is in the middle.
Eyes eyes_before(const sensing::Screen& screen, double apart_m);

/// A barrier of slits before the screen, or behind it where the gap is negative.
struct Barrier {
  double pitch_m = 0;  ///< from slit to slit
  double gap_m = 0;    ///< from the screen to the barrier, towards the eyes
  double phase = 0;    ///< a slit is that part of a pitch to the right of the screen's middle; of rows, above it
};
/// The one with which neighbouring columns of a picture so wide are seen by different eyes. Of rows (`high` of them) as
/// many go to either eye: it has no gap.
Barrier usual_barrier(const sensing::Screen& screen, const Eyes& eyes, Stereo stereo, std::uint32_t width,
                      std::uint32_t height);

/// Whether a place on the screen, metres from its middle along x (`columns`) or y (`rows`), is the left eye's. With
/// columns it belongs to the eye that sees it nearer to the middle of a slit; rows take turns, as the point between the
/// eyes sees them.
bool is_left(const sensing::Screen& screen, const Eyes& eyes, const Barrier& barrier, Stereo stereo, double place_m);

/// The size of one eye's picture in a whole of that size.
struct EyeSize {
  std::uint32_t width = 0, height = 0;
};
EyeSize eye_size(Stereo stereo, std::uint32_t width, std::uint32_t height);

/// Two eyes' pictures of that size as one. Not for Stereo::none.
drawing::Pixels combine(const drawing::Pixels& left, const drawing::Pixels& right, const sensing::Screen& screen,
                        const Eyes& eyes, const Barrier& barrier, Stereo stereo);

/// The picture at that size, no smaller than its own: its last column and row once more where halving an odd size has
/// left a pixel over.
drawing::Pixels grown_to(drawing::Pixels picture, std::uint32_t width, std::uint32_t height);

}  // namespace palpa::viewer
