// Arrays, drives and fields as Python objects.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <span>
#include <string>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"

namespace palpa::python {

namespace py = pybind11;

/// `palpa.Layout`.
struct LayoutObject {
  array::Layout layout;
  std::string source;  ///< the name or file from which it was loaded; empty: a moved one
};

/// `palpa.Drive`.
struct DriveObject {
  setup::DriveResult result;
};

/// `palpa.Field`.
struct FieldObject {
  setup::FieldResult result;
};

/// `palpa.FingerInSound`: the sound of a layout's transducers around a finger.
struct FingerSoundObject {
  std::shared_ptr<const LayoutObject> layout;
  setup::DriveOptionsGroup drive;
  std::unique_ptr<setup::FingerInSound> finger;
  std::string name;
};

/// Adds the classes Drive and Field.
void add_sounds(py::module_& m);

/// The drive of these foci by a Python function, checked like the content of a file. The function gets the transfer
/// matrix (n, M) and the gains (n,), and returns a complex vector (M,). Needs the interpreter's lock.
array::Drive drive_by(const py::object& solver, const array::Layout& layout, std::span<const array::SlotFocus> foci,
                      const array::DriveOptions& options);

/// A Layout, or a name or file to be loaded.
std::shared_ptr<const LayoutObject> layout_of(const char* name, const py::object& value);

}  // namespace palpa::python
