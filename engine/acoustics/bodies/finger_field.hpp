// The radiation pressure of a focus on one rigid finger. It is the full (Langevin) radiation pressure of radiation.hpp
// at the finger's skin. It is computed from the total field, which includes the sound that the finger scatters. Use it
// instead of the array's field in free air (array_field.hpp). It needs an incident wave and a solution per focus. The
// path runs from focus to focus through the finger; its places are mapped to the nearest points of the skin.
//
// The sound of a focus is the drive for this focus alone. Absorption by air is included.
#pragma once

#include <optional>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/focus_field.hpp"
#include "acoustics/field/incident.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::acoustics {

class FingerField final : public FocusField {
 public:
  /// Everything is in one frame; body, layout and transfer must outlive it. Foci are made for the finger by `transfer`,
  /// which is aimed again in every call; without it, for free air. The drive's solver does not matter, because each
  /// focus is alone. `pressure_pa` is the pressure requested at each focus and replaces the constraint.
  FingerField(const RigidBody& body, const array::Layout& layout, const Air& air, const array::DriveOptions& drive,
              FingerTransfer* transfer = nullptr, std::optional<double> pressure_pa = {});

  FocusKind kind() const override { return FocusKind::finger; }
  double step_m() const override;
  Vec3 skin_at(const Vec3& place) const override;

  /// In pascals. With a transfer, only one thread at a time may call it.
  bool felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
            const std::atomic<bool>* give_up = nullptr) const override;

 private:
  const RigidBody& body_;
  const array::Layout& layout_;
  Air air_;
  array::DriveOptions drive_;
  FingerTransfer* transfer_;
  std::optional<double> pressure_pa_;
  Incident incident_;
  BodyPlaces places_;
};

}  // namespace palpa::acoustics
