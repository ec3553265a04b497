// A schedule whose fingers ask for a pressure: how loud each of them can be, and the factors of every slot's foci.
//
// What a finger asks (Voice::pressure_pa, times its gain) is the peak pressure at each of its foci by the directivity,
// without absorption, at its modulation's crest: in every slot, whatever else sounds (slot_pressures.hpp). Where the
// amplitude of some transducer would exceed 1 in some slot, fingers are lowered, each by one factor for all of its foci
// and slots (levels.hpp). A finger that asks for none, beside one that does, sounds as the paper has it, by what is
// left of the array, or by less where the array does not resolve it from one that asks: only who asks may raise others.
// In slots of more than most_solved_foci foci nobody is louder than asked (crowd.hpp).
//
// All in double precision and the same on every run; a device only adds up the drives.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/levels.hpp"
#include "array/reach.hpp"
#include "array/schedule.hpp"
#include "array/slot_pressures.hpp"

namespace palpa::array {

class Loudness {
 public:
  /// `layout` outlives it. Of the options constraint and a solver's greed do not count.
  Loudness(const Layout& layout, const DriveOptions& options);

  /// Whether some voice of the schedule asks for a pressure.
  static bool asked(const Schedule& schedule);

  /// Looks at the slots 0 .. `slots` - 1 and fills target and reached pressure of all voices. Keeps its storage.
  void solve(Schedule& schedule, std::uint32_t slots);
  /// The factors of a slot's foci, in the order of foci_of_slot, 0 for foci that cannot be driven; with them no
  /// transducer exceeds 1. Valid until the next solve.
  std::span<const std::complex<double>> factors(std::uint32_t slot) const;

 private:
  /// Foci that are solved together: their entries are [first, first + count) of `factors_`, `targets_` and so on.
  struct Part {
    std::size_t first = 0, count = 0;
    FocusMatrix matrix;
  };
  /// One slot, which is one part, or several (crowd.hpp).
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
  /// The largest amplitude of the slot; where `takes` is not empty each voice's own is entered, too, where it is
  /// larger.
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
  Reach reach_;
  FreeField free_field_;
  Columns columns_;
  PressureScratch scratch_;

  std::vector<Slot> slots_;
  std::size_t slot_count_ = 0;
  std::vector<Part> parts_;
  std::size_t part_count_ = 0;
  std::vector<SlotFocus> foci_, slot_foci_;    ///< of all slots, and of one
  std::vector<double> targets_;                ///< all that is asked, in 1/m
  std::vector<double> given_;                  ///< what part of it a focus alone could have, 0..1
  std::vector<std::complex<double>> full_;     ///< factors that give that part,
  std::vector<std::complex<double>> factors_;  ///< and those that are played
  std::vector<Demand> demands_;                ///< of the voices
  std::vector<double> levels_, shared_;
  /// What each focus of each voice asks of the transducers, [ask_of_[voice] + number]: transducer by transducer.
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
