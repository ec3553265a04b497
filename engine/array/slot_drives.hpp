// The drives of several slots on the host: side by side, if that pays.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::array {

/// Keeps its storage from batch to batch. All batches have the same layout and options.
class SlotDrives {
 public:
  /// Reserves all that a batch needs for this many slots, with this many foci in all slots together.
  void reserve(const Layout& layout, const DriveOptions& options, std::size_t slots, std::size_t foci);

  void clear();
  /// Adds the next slot. `factors`: one per focus, for drive_by_factors; empty: drive_for.
  void add(std::span<const SlotFocus> foci, std::span<const std::complex<double>> factors);
  std::size_t size() const { return slots_.size(); }

  /// Writes the drives of all slots to `out`, slot after slot, one entry per transducer, with the same bytes on any
  /// number of threads. Starts other threads only if the slots are not done within 2 ms.
  void solve(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out);

 private:
  struct Slot {
    std::size_t begin = 0, count = 0;  ///< of `foci_`, and of `factors_`
    bool by_factors = false;
  };
  void solve(const Layout& layout, const DriveOptions& options, std::size_t begin, std::size_t end,
             std::span<TransducerDrive> out, DriveScratch& scratch) const;

  std::vector<Slot> slots_;
  std::vector<SlotFocus> foci_;
  std::vector<std::complex<double>> factors_;
  std::vector<DriveScratch> scratch_;  ///< one per thread
};

}  // namespace palpa::array
