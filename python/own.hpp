// The caller's own functions as method and solver. The engine calls them on the thread that computes, and their results
// are checked like the content of a file. What they raise ends a live run in silence. Their code is in options.cpp.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>
#include <span>

#include "geometry/solid.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/options/options.hpp"

namespace palpa::python {

namespace py = pybind11;

struct OwnFunctions {
  py::object method, solver;        ///< null: palpa's own
  std::exception_ptr fault;         ///< what one of them raised first; none is called before throw_fault()
  bool live = false;                ///< a fault ends the run at once: it throws failure() through the engine
  std::atomic<double> called_s{0};  ///< since when Python code runs, on the steady clock; 0: none runs

  /// Python code runs during its lifetime.
  struct Called {
    std::atomic<double>& since;
    explicit Called(OwnFunctions& own);
    ~Called() { since = 0; }
    Called(const Called&) = delete;
    Called& operator=(const Called&) = delete;
  };

  /// Throws what a function raised, and forgets it. Needs the interpreter's lock.
  void throw_fault();
};

/// Takes the function `method` from the keyword arguments, which keep it if it is a text. Throws bad_usage for options
/// that have no effect with a function.
void take_method(const py::kwargs& arguments, OwnFunctions& functions);
/// The same for `solver`.
void take_solver(const py::kwargs& arguments, OwnFunctions& functions);

/// Calls `functions.method` with a Finger on one of `solids`; it returns foci (n, 3), 1 to touch::max_foci. After a
/// fault, the focus is the finger's centroid. Empty if there is no function. `functions` must outlive it.
session::OwnMethod own_method(OwnFunctions& functions, std::span<const geometry::Solid> solids);
/// Calls `functions.solver` as drive_by (layout.hpp) does. After a fault, drives are silent. Empty if there is no
/// function.
session::OwnSolver own_solver(OwnFunctions& functions);

}  // namespace palpa::python
