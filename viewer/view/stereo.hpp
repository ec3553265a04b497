// What a participant sees on a screen in the workspace. Each eye looks through the screen as through a window, so that
// things appear where they are felt. The pictures of the two eyes are combined in the way in which the screen separates
// them.
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
  top_bottom,    ///< the left eye's picture above the right eye's
  anaglyph,      ///< red for the left eye, cyan for the right
  columns,       ///< interleaved for a parallax barrier of upright slits
  rows,          ///< interleaved by rows
};
inline constexpr Word<Stereo> stereo_words[] = {
    {"none", Stereo::none},         {"side-by-side", Stereo::side_by_side}, {"top-bottom", Stereo::top_bottom},
    {"anaglyph", Stereo::anaglyph}, {"columns", Stereo::columns},           {"rows", Stereo::rows}};

/// Whether the screen's own eye, and so the participant, is in front of it.
bool in_front(const sensing::Screen& screen);
/// What the eye sees through the screen; the screen's picture shows exactly that. Throws bad_usage if the eye is not in
/// front of the screen.
Frustum onto(const sensing::Screen& screen, const Vec3& eye);

struct Eyes {
  Vec3 left{}, right{};  ///< world
};
/// Side by side along the screen's x, `apart_m` from each other; the screen's eye is in the middle.
Eyes eyes_before(const sensing::Screen& screen, double apart_m);

/// A barrier of slits in front of the screen, or behind it if the gap is negative.
struct Barrier {
  double pitch_m = 0;  ///< from slit to slit
  double gap_m = 0;    ///< from the screen to the barrier, towards the eyes
  double phase = 0;    ///< offset of a slit to the right of the screen's middle, in pitches; with rows, above it
};
/// The barrier with which different eyes see neighbouring columns of a picture that is `width` wide. With rows
/// (`height` of them), each eye gets half of them, and the barrier has no gap.
Barrier default_barrier(const sensing::Screen& screen, const Eyes& eyes, Stereo stereo, std::uint32_t width,
                        std::uint32_t height);

/// Whether a place on the screen, in metres from its middle along x (`columns`) or y (`rows`), belongs to the left eye.
/// With columns, it belongs to the eye that sees it nearer to the middle of a slit. Rows alternate, as seen from the
/// point between the eyes.
bool is_left(const sensing::Screen& screen, const Eyes& eyes, const Barrier& barrier, Stereo stereo, double place_m);

/// The size of one eye's picture in a whole picture of that size.
struct EyeSize {
  std::uint32_t width = 0, height = 0;
};
EyeSize eye_size(Stereo stereo, std::uint32_t width, std::uint32_t height);

/// Combines the pictures of two eyes, each of that size. Not for Stereo::none.
drawing::Pixels combine(const drawing::Pixels& left, const drawing::Pixels& right, const sensing::Screen& screen,
                        const Eyes& eyes, const Barrier& barrier, Stereo stereo);

/// The picture at that size, which must not be smaller than its own. Its last column and row are repeated if halving an
/// odd size has left a pixel over.
drawing::Pixels grown_to(drawing::Pixels picture, std::uint32_t width, std::uint32_t height);

}  // namespace palpa::viewer
