// A schedule whose fingers request a pressure: how loud each of them can be, and the factors of every slot's foci.
//
// A finger's request (Voice::pressure_pa, times its gain) is the peak pressure at each of its foci at the crest of its
// modulation, with directivity and without absorption. It holds in every slot, regardless of other foci
// (slot_pressures.hpp). If the amplitude of some transducer would exceed 1 in some slot, fingers are lowered, each by
// one factor for all of its foci and slots (levels.hpp). If some fingers have no request, they sound as in the paper,
// with the rest of the array. Such a finger gets less if the array does not resolve it from a finger with a request,
// because it must not make the latter louder. In slots of more than most_solved_foci foci no focus is louder than
// requested (many_foci.hpp).
//
// Everything is in double precision and the same on every run; a device only sums up the drives.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/field/farthest.hpp"
#include "array/field/free_field.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/levels.hpp"
#include "array/pressures/slot_pressures.hpp"
#include "array/schedule.hpp"

namespace palpa::array {

class Loudness {
 public:
  /// `layout` must outlive it. The options' constraint and the solver `greedy` have no effect.
  Loudness(const Layout& layout, const DriveOptions& options);

  /// Whether some voice of the schedule requests a pressure.
  static bool asked(const Schedule& schedule);

  /// Evaluates the slots 0 .. `slots` - 1 and fills target and reached pressure of all voices. Keeps its storage.
  void solve(Schedule& schedule, std::uint32_t slots);
  /// The factors of a slot's foci, in the order of foci_of_slot, 0 for foci that cannot be driven. With these factors,
  /// no transducer exceeds 1. Valid until the next solve.
  std::span<const std::complex<double>> factors(std::uint32_t slot) const;

 private:
  /// Foci that are solved together: their entries are [first, first + count) of `factors_`, `targets_` and so on.
  struct Part {
    std::size_t first = 0, count = 0;
    FocusMatrix matrix;
  };
  /// One slot, which consists of one or several parts (many_foci.hpp).
  struct Slot {
    std::size_t first = 0, count = 0;
    std::size_t first_part = 0, parts = 0;
  };

  const Transfer& transfer() const { return options_.transfer ? *options_.transfer : free_field_; }
  void add_slot(const Schedule& schedule, std::uint32_t number);
  void add_part(const Schedule& schedule, Part& part);
  void correct(const Part& part, std::span<std::complex<double>> factors);
  void find_sources(std::size_t first, std::size_t count);
  void keep_asks(const Part& part);
  /// The largest amplitude of the slot. If `takes` is not empty, each voice's own amplitude is entered if it is larger.
  double peak_of(const Slot& slot, std::span<Demand> takes);
  void apply_levels();
  double peak_of_all();
  void share();
  double quieten_unasked();
  void calm(const Slot& slot);
  void hear(const Slot& slot);  ///< into `heard_`
  double own_pressure(const Slot& slot, std::size_t focus) const;
  void tell(Schedule& schedule);
  std::span<const Slot> used() const { return std::span(slots_).first(slot_count_); }

  const Layout& layout_;
  DriveOptions options_;
  FarthestTransducer farthest_;
  FreeField free_field_;
  Columns columns_;
  PressureScratch scratch_;

  std::vector<Slot> slots_;
  std::size_t slot_count_ = 0;
  std::vector<Part> parts_;
  std::size_t part_count_ = 0;
  std::vector<SlotFocus> foci_, slot_foci_;    ///< of all slots, and of one
  std::vector<double> targets_;                ///< full requests, in 1/m
  std::vector<double> given_;                  ///< the share of it that a focus alone could have, 0..1
  std::vector<std::complex<double>> full_;     ///< factors that give that share,
  std::vector<std::complex<double>> factors_;  ///< and the factors that are played
  std::vector<Demand> demands_;                ///< of the voices
  std::vector<double> levels_, shared_;
  /// The drive of each focus of each voice, [ask_of_[voice] + number]: one entry per transducer.
  struct Ask {
    bool known = false;
    std::vector<float> re, im;
  };
  std::vector<Ask> asks_;
  std::vector<std::size_t> ask_of_;
  std::vector<FocusSource> sources_;
  std::vector<std::complex<double>> heard_;
  std::vector<double> now_;
  std::vector<std::complex<double>> own_;
  std::vector<float> re_, im_, own_re_, own_im_;
};

}  // namespace palpa::array
