// What boards play of a drive whose fingers request a pressure. The steps of amplitudes are far apart at low ones, so
// the nearest of each transducer may give a focus more than it asks for.
//
//   p_j(x)   the pressure at focus j of what the boards play of x times the drive (BoardPlay::play)
//   P_j      the pressure that the exact drive has there
//
//   x is the largest for which p_j(x) <= P_j at each focus that requests a pressure
//
// x is the end of a search: the largest one wherever p grows with x, as it does for one focus. Between the crests of
// its modulation, where a focus hears mostly others, its limit is the request at the crest.
#pragma once

#include <span>
#include <vector>

#include "array/drive.hpp"
#include "array/field/free_field.hpp"
#include "array/layouts/board_play.hpp"

namespace palpa::array {

class RequestedPlay {
 public:
  /// In the free field of the options' medium and directivity. Layout and boards must outlive it.
  RequestedPlay(const Layout& layout, const BoardPlay& boards, const DriveOptions& options);

  /// Rounds amplitudes in place, to those on the wire. `foci` are those of the drive, before the drive was multiplied
  /// by `scale`: the ceiling and the ramp. No transducer is above `ceiling`. Keeps its storage.
  void round(std::span<TransducerDrive> drive, std::span<const SlotFocus> foci, double ceiling, double scale);

  /// A focus of the last call that requests a pressure, and what it has of the pressure of the exact drive.
  struct Part {
    std::uint32_t voice = 0;
    double played = 1;
    bool at_crest = true;  ///< otherwise it hears mostly others
  };
  std::span<const Part> parts() const { return parts_; }
  /// How often the last call looked at a factor.
  int looks() const { return looks_; }

 private:
  struct Limit {
    double pascals = 0, exact_pa = 0;
  };
  void find_foci(std::span<const SlotFocus> foci);
  void find_weights(std::span<const TransducerDrive> drive);
  void find_limits(std::span<const TransducerDrive> drive, std::span<const SlotFocus> foci, double scale);
  double pressure_of(std::size_t focus, std::span<const float> amplitudes) const;
  double loudest_part(std::span<const float> amplitudes) const;
  void search(std::span<const TransducerDrive> drive, double ceiling);

  const Layout& layout_;
  const BoardPlay& boards_;
  FreeField field_;
  Columns columns_;
  std::vector<FocusSource> sources_;
  std::vector<double> cosine_, sine_;  ///< of the drive's phases
  std::vector<float> re_, im_;         ///< by focus and transducer: the pressure of a transducer at full amplitude, Pa
  std::vector<std::size_t> asks_;      ///< which of the foci request a pressure
  std::vector<Limit> limits_;
  std::vector<Part> parts_;
  std::vector<float> exact_, played_, best_;
  int looks_ = 0;
};

}  // namespace palpa::array
