// What the solvers are told apart by.
#pragma once

#include "array/drive_options.hpp"
#include "array/pressures/slot_pressures.hpp"
#include "array/solvers/loud_phases.hpp"

namespace palpa::array {

/// The phases that the solver uses for foci that request pressures.
constexpr FocusPhases phases_of(Solver solver) {
  return is_gs_pat(solver) ? FocusPhases::helping : FocusPhases::own;
}

constexpr Care care_of(Solver solver) {
  return solver == Solver::loudest ? Care::most : Care::usual;
}

}  // namespace palpa::array
