// The log of one run of a sitting, made from its journal: _events.tsv with its sidecar, and the stimuli of its touches.
// A run is what lies between two starts of the program. All of these are texts: nothing is read or written here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "study/files/journal.hpp"
#include "study/plan/order.hpp"
#include "study/plan/plan.hpp"

namespace palpa::study {

/// The entries of each run, in their order.
std::vector<std::span<const Entry>> runs_of(std::span<const Entry> entries);

/// A touch that has ended.
struct PlayedStep {
  const Entry* entry = nullptr;  ///< `touched`
  std::int64_t begin_ns = 0;     ///< of its step
  std::string shape{};           ///< by name
};
/// The touches of a run, or of several, in their order.
std::vector<PlayedStep> played_steps(const StudyPlan& plan, std::span<const Step> steps,
                                     std::span<const Entry> entries);

/// The table, one row per step that was begun. Rows that were broken off, and the last one if the program ended in the
/// middle of it, have the status void.
std::string events_table(const StudyPlan& plan, std::span<const Step> steps, std::span<const Entry> run);

/// The sidecar. `ended`: with the table's checksum, because nothing follows.
std::string events_sidecar(const StudyPlan& plan, std::uint32_t participant, std::span<const Entry> run,
                           const std::string& table, bool ended);

/// What was played, as JSON: one member of "touches" per touch that has ended.
std::string stimuli_json(const StudyPlan& plan, std::span<const Step> steps, std::span<const Entry> run);

}  // namespace palpa::study
