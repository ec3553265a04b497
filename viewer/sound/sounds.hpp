// The sound in a picture: the pressure on the finger, the field in a plane and the spectrum, each begun when it is
// first wanted, and computed beside whoever draws.
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

  /// From now on pressures are of the closed mesh in this file; empty: of none.
  void set_finger(const std::string& file);
  /// What the layers of `state` show of `now`, with the spectrum where it is wanted; see Heat, SlicePreview, Spectra.
  Change look(const Sounding& now, const ViewState& state, bool spectrum, Picture& picture, double now_s);
  /// The picture is another.
  void forget();
  /// Whether something will change by itself.
  bool busy() const { return busy_; }
  /// Of each finger; empty where none is wanted or nothing plays.
  const std::vector<acoustics::Spectrum>& spectra() const { return spectra_; }
  /// What went wrong since the last call, a line each; none of them twice.
  std::vector<std::string> faults() { return std::exchange(faults_, {}); }

 private:
  void heed(const std::string& fault);

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
