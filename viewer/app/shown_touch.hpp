// A single touch, or a sensation, from the command line to a picture, slot by slot: loads what is shown and lets the
// engine touch it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/schedule.hpp"
#include "base/math.hpp"
#include "sensation/played.hpp"
#include "session/sensation_run.hpp"
#include "session/session.hpp"
#include "viewer/options/viewer_options.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/sound/field_slice.hpp"
#include "viewer/sound/sounding.hpp"

namespace palpa::viewer {

/// A sensation as a picture, slot by slot: where the focus is, and where it was last.
class ShownSensation {
 public:
  /// `name` is a file or one of palpa's own. The array, which stands in the world, has this pose. Throws as palpa play.
  ShownSensation(const std::string& name, std::span<const std::string> parameters, const array::Layout& layout,
                 const Transform& T_world_array);

  double slot_s() const { return slot_s_; }
  /// Shows the slot, and returns its focus in the world. After a stop, or setup::most_offline_slots, it begins again.
  array::SlotFocus show(Picture& picture, std::uint64_t slot);

 private:
  void evaluate(std::uint64_t slot);

  std::string name_;
  sensation::PatternSensation sensation_;
  double slot_s_;
  Transform T_world_array_;
  session::PlaceWatch watch_;
  sensation::State state_ = sensation::State::at(0);
  std::vector<sensation::Point> points_;  ///< of the slots so far
  bool whole_ = false;                    ///< there are no others
};

class ShownTouch {
 public:
  /// Reads the files and finds contacts, fingers and foci. Throws as the engine does.
  explicit ShownTouch(const ViewerOptions& options);

  const Picture& picture() const { return picture_; }
  Picture& picture() { return picture_; }
  /// Shows the running foci, or the sensation's focus, and the drive of that slot.
  void go_to(std::uint64_t slot);
  /// Puts the field of that drive into the picture. Without a drive, does nothing.
  void show_field(FieldSlice& field, const SliceState& slice);

  /// The layout of --layout or of the rig, in the world.
  const array::Layout& layout() const { return *layout_; }
  /// The length of the sensation's slots, if there is a sensation.
  std::optional<double> slot_s() const { return sensation_ ? std::optional(sensation_->slot_s()) : std::nullopt; }
  /// What sounds in the slot of go_to(), and what is felt of all slots. Valid as long as this object lives and no other
  /// slot is shown. It has a plan if there are --skin and an array.
  Sounding sounding() const;

 private:
  void load_objects(const ViewerOptions& options);
  void show_skin(const setup::TouchInput& input, std::span<const geometry::Solid> solids, const touch::Touch& touch);
  void load_skin_surface(const ViewerOptions& options);
  void warn_of_other_skin(const ViewerOptions& options, const geometry::Mesh& skin) const;
  void load_array(const ViewerOptions& options);
  void take_array(const array::Layout& layout, const Transform& T_world_layout);

  Picture picture_;
  array::Schedule schedule_;
  std::optional<ShownSensation> sensation_;
  std::shared_ptr<const array::Layout> layout_;  ///< in the world; without transducers if there is no array
  std::optional<session::Plan> plan_;
  acoustics::Air air_;
  std::optional<double> spot_m_;
  double skin_lowered_m_ = 0;
  array::DriveOptions drive_options_;
  std::vector<array::SlotFocus> foci_;
  array::Drive drive_;
  array::DriveScratch drive_scratch_;
};

}  // namespace palpa::viewer
