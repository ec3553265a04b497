// What one rigid finger feels of a focus: the radiation pressure in full (radiation.hpp, Langevin) at its skin, of the
// total field, the sound that the finger scatters included. It takes the place of the array's field in free air
// (array_field.hpp), with an incident wave and a solution per focus; places are those of the skin that are nearest to
// the path's, which runs from focus to focus through the finger.
//
// The sound of a focus is the drive that it has alone. Air absorbs what it does there.
#pragma once

#include <optional>

#include "acoustics/air.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/field/focus_field.hpp"
#include "acoustics/field/incident.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"

namespace palpa::acoustics {

class FingerField final : public FocusField {
 public:
  /// All in one frame; body, layout and transfer outlive it. Foci are made for the finger by `transfer`, which is aimed
  /// anew in every call; without it for free air. Of the drive's options the solver does not count: a focus is alone.
  /// `pressure_pa`: asked for at each focus, in the place of the constraint.
  FingerField(const RigidBody& body, const array::Layout& layout, const Air& air, const array::DriveOptions& drive,
              FingerTransfer* transfer = nullptr, std::optional<double> pressure_pa = {});

  FocusKind kind() const override { return FocusKind::finger; }
  double step_m() const override;
  Vec3 skin_at(const Vec3& place) const override;

  /// In pascals. One thread at a time may call it where it has a transfer.
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
