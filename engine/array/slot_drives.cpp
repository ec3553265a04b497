#include "array/slot_drives.hpp"

#include <algorithm>
#include <cassert>

#include "base/system/now.hpp"
#include "base/system/parallel.hpp"

namespace palpa::array {
namespace {

/// Starting a thread takes a twentieth of this. It also disturbs the thread that sends drives on time.
constexpr double alone_ms = 2;

}  // namespace

void SlotDrives::reserve(const Layout& layout, const DriveOptions& options, std::size_t slots, std::size_t foci) {
  slots_.reserve(slots);
  foci_.reserve(foci);
  factors_.reserve(foci);
  scratch_.resize(worker_count());
  for (DriveScratch& scratch : scratch_)
    array::reserve(scratch, layout, options, foci);
}

void SlotDrives::clear() {
  slots_.clear();
  foci_.clear();
  factors_.clear();
}

void SlotDrives::add(std::span<const SlotFocus> foci, std::span<const std::complex<double>> factors) {
  slots_.push_back({foci_.size(), foci.size(), !factors.empty()});
  foci_.insert(foci_.end(), foci.begin(), foci.end());
  factors_.insert(factors_.end(), factors.begin(), factors.end());
  factors_.resize(foci_.size());
}

void SlotDrives::solve(const Layout& layout, const DriveOptions& options, std::span<TransducerDrive> out) {
  assert(out.size() == slots_.size() * layout.transducers.size());
  if (slots_.empty()) return;
  if (scratch_.empty()) scratch_.resize(worker_count());
  // A transfer other than the free field may have scratch of its own.
  const bool may_have_help = options.transfer == nullptr && scratch_.size() > 1;
  const double until_ms = now_ms() + alone_ms;
  std::size_t done = 0;
  while (done < slots_.size() && !(may_have_help && now_ms() > until_ms)) {
    solve(layout, options, done, done + 1, out, scratch_[0]);
    ++done;
  }
  const std::size_t rest = slots_.size() - done;
  if (rest == 0) return;
  parallel_chunks(rest, chunk_count(rest, scratch_.size()),
                  [&](std::size_t thread, std::size_t begin, std::size_t end) {
                    solve(layout, options, done + begin, done + end, out, scratch_[thread]);
                  });
}

void SlotDrives::solve(const Layout& layout, const DriveOptions& options, std::size_t begin, std::size_t end,
                       std::span<TransducerDrive> out, DriveScratch& scratch) const {
  const std::size_t transducers = layout.transducers.size();
  for (std::size_t i = begin; i < end; ++i) {
    const Slot& slot = slots_[i];
    const auto foci = std::span(foci_).subspan(slot.begin, slot.count);
    const auto drive = out.subspan(i * transducers, transducers);
    if (slot.by_factors) {
      drive_by_factors(layout, foci, std::span(factors_).subspan(slot.begin, slot.count), options, drive, scratch);
    } else {
      drive_for(layout, foci, options, drive, scratch);
    }
  }
}

}  // namespace palpa::array
