// The sound in a picture: the pressure on the finger, the field in a plane and the spectrum, each begun when it is
// first wanted, and computed in the background.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "session/answer_thread.hpp"
#include "viewer/sound/heat.hpp"
#include "viewer/sound/slice_preview.hpp"
#include "viewer/sound/sounding.hpp"

namespace palpa::viewer {

struct SpectraQuestion {
  array::Schedule schedule;
  std::shared_ptr<const array::Layout> layout;  ///< null: spots
  array::DriveOptions drive;
  std::optional<double> spot_m;
};

struct SpectraAnswer {
  std::uint64_t number = 0;
  std::string fault;
  std::vector<acoustics::Spectrum> spectra;  ///< one per voice
};

/// What skin feels of the schedule that plays, computed in the background.
class Spectra {
 public:
  Spectra();

  /// Asks again if what plays has changed since the last question, at most a few times a second. Returns true if
  /// spectra() are new. Never waits.
  bool look(const Sounding& now, double now_s);
  const std::vector<acoustics::Spectrum>& spectra() const { return spectra_; }
  /// Whether a later look() will find new spectra.
  bool busy() const { return answers_.stale() || answers_.newest()->number > shown_; }
  /// Why there are none; else empty.
  const std::string& fault() const { return fault_; }

 private:
  std::optional<SpectraQuestion> asked_;
  std::uint64_t shown_ = 0;
  double next_s_ = 0;
  std::vector<acoustics::Spectrum> spectra_;
  std::string fault_;
  session::AnswerThread<SpectraQuestion, SpectraAnswer> answers_;
};

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
