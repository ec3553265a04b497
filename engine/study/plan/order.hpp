// The order of a participant's sitting, as a function of the plan and of the participant's number only. Every random
// draw can be repeated: the same plan and number give the same order, on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "study/plan/plan.hpp"

namespace palpa::study {

inline constexpr std::uint32_t most_participant_number = 999'999;

/// The rule if a plan has none: as in the paper for two methods, a Williams square for more.
OrderRule default_order(std::size_t methods);

/// The rows of a Williams square of `methods` conditions: n for even n, 2 n for odd n. Over all rows, each condition
/// stands in each place equally often, and follows each other one equally often (Williams 1949).
std::vector<std::vector<std::uint32_t>> williams_square(std::uint32_t methods);

/// The methods in the participant's order, as indices into the plan's.
std::vector<std::uint32_t> methods_of(const StudyPlan& plan, std::uint32_t participant);

/// One thing that a participant does: a touch with its answer, the free exploration, a break.
struct Step {
  std::uint32_t round = 0;               ///< steps of one round belong together: one block of the plan, with one method
  std::uint32_t block = 0;               ///< index into the plan's blocks
  std::uint32_t method = 0;              ///< index into the plan's methods
  std::optional<std::uint32_t> shape{};  ///< index into the plan's shapes

  bool operator==(const Step&) const = default;
};

/// All steps in their order.
std::vector<Step> order_of(const StudyPlan& plan, std::uint32_t participant);

/// The number of steps of any participant. Counts above most_planned_steps may be too small.
std::size_t count_steps(const StudyPlan& plan);

/// The order as a table: `step,kind,method,shape`, one row per step.
std::string order_csv(const StudyPlan& plan, const std::vector<Step>& steps);

}  // namespace palpa::study
