// What skin feels of the schedule that plays, computed in the background.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "session/answer_thread.hpp"
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

}  // namespace palpa::viewer
