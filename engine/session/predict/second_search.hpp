// Contacts, cross-section and foci of a finger that has moved on: the touch of the same skin in another place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sensing/skin_point.hpp"
#include "sensing/skin_twin.hpp"
#include "session/predict/kept_frames.hpp"
#include "shaders/touch/contacts/reach.h"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// A finger's box: that of its contacts, as far as its cross-section tells.
Box contact_box(const touch::Finger& finger);

class SecondSearch {
 public:
  /// `solids` are those of the session's stage, which may move; both must outlive this object.
  SecondSearch(const CameraView& view, const touch::PreparedSolids& solids, const touch::FingerOptions& parameters);

  /// The skin that moves with a finger is within this distance of its contacts' box.
  double reach_m() const { return reach_m_; }
  void set_pixel_stride(std::uint32_t stride) { stride_ = stride; }

  /// Moves finger `f` of `seen` by `way`, with the skin of `frames` that is nearer to it than to other fingers, and
  /// adds it to `out`, if it still touches: if at least min_points of its skin points are contacts, or half of that if
  /// the finger holds. A finger that holds and whose inward side is known touches until none of its skin is within 0.5
  /// mm of the shell; with fewer contacts, it moves rigidly. Its foci are moved by what the way changes: each by the
  /// difference between its sector's centroid before and after. So a way of zero changes nothing, and the foci keep
  /// their smoothing. The axes stay. Returns whether it was added.
  bool move(const touch::Touch& seen, std::uint32_t f, const Vec3& way, const KeptFrames& frames, touch::Touch& out);

 private:
  bool move_at(const touch::Touch& seen, std::uint32_t f, const Vec3& way, const KeptFrames& frames,
               std::uint32_t largest_stride, touch::Touch& out);
  void take_points(const touch::Touch& seen, std::uint32_t f, const KeptFrames& frames, const Vec3& way,
                   std::uint32_t largest_stride);
  bool find(const touch::Finger& finger, std::span<const sensing::SkinPoint> points,
            const touch::FingerOptions& parameters, touch::Touch& out) const;
  /// Whether some of the points are contacts of the finger's solid, or would be 0.5 mm deeper or shallower.
  bool is_near(const touch::Finger& finger, std::span<const sensing::SkinPoint> points,
               const touch::FingerOptions& parameters);

  CameraView view_;
  const touch::PreparedSolids& solids_;
  touch::FingerOptions parameters_;
  double reach_m_;
  std::uint32_t stride_ = 1, points_stride_ = 1;  ///< of the session; of the points of the last search
  // Scratch that keeps its storage.
  std::vector<sensing::Crop> crops_;
  std::vector<shader::SkinVolume> volumes_;
  sensing::SkinOfFrame skin_;
  std::vector<Box> others_;
  std::vector<sensing::SkinPoint> points_, moved_;
  touch::Touch before_, after_;
  shader::ReachTable reach_{};
};

/// Copies finger `f` of `seen` to the end of `out`, moved rigidly by `way`, with its contacts.
touch::Finger& add_moved(const touch::Touch& seen, std::uint32_t f, const Vec3& way, touch::Touch& out);

}  // namespace palpa::session
