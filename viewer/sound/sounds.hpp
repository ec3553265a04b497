// The sound in a picture: the pressure on the finger, the field in a plane and the spectrum, each begun when it is
// first wanted, and computed in the background.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "viewer/sound/heat.hpp"
#include "viewer/sound/slice_preview.hpp"
#include "viewer/sound/spectra.hpp"

namespace palpa::viewer {

class Sounds {
 public:
  /// `device`: where planes are computed.
  explicit Sounds(gpu::DeviceOptions device) : device_(std::move(device)) {}

  /// From now on, pressures are computed for the closed mesh in this file; empty: for none.
  void set_finger(const std::string& file);
  /// Updates what the layers of `state` show of `now`, and the spectrum if it is wanted; see Heat, SlicePreview,
  /// Spectra.
  Change look(const Sounding& now, const ViewState& state, bool spectrum, Picture& picture, double now_s);
  /// Call for another picture.
  void forget();
  /// Whether something will change by itself.
  bool busy() const { return busy_; }
  /// One for each finger; empty if none is wanted or nothing plays.
  const std::vector<acoustics::Spectrum>& spectra() const { return spectra_; }
  /// The errors since the last call, one line each. No error is returned twice.
  std::vector<std::string> faults() { return std::exchange(faults_, {}); }

 private:
  void keep_fault(const std::string& fault);

  std::string finger_;
  gpu::DeviceOptions device_;
  std::optional<Heat> heat_;
  std::optional<SlicePreview> slice_;
  std::optional<Spectra> felt_;
  std::vector<acoustics::Spectrum> spectra_;
  std::vector<std::string> faults_;
  std::set<std::string> told_;
  bool busy_ = false;
};

}  // namespace palpa::viewer
