// Arrays, drives and fields as Python objects.
#pragma once

#include <pybind11/pybind11.h>

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"

namespace palpa::python {

namespace py = pybind11;

/// `palpa.Layout`.
struct LayoutObject {
  array::Layout layout;
  std::string source;  ///< the name or file from which it was loaded; empty: a moved one
  /// The transducers where they stood before they were moved; null: they were not.
  std::shared_ptr<const std::vector<array::Transducer>> unmoved{};
  mutable std::shared_ptr<array::KnownLayout> known{};  ///< if it has no file and was an option

  /// The name or file by which options name it.
  std::string option() const;
};

/// `palpa.Drive`.
struct DriveObject {
  setup::DriveResult result;
  std::shared_ptr<LayoutObject> layout{};
};

/// `palpa.Field`.
struct FieldObject {
  setup::FieldResult result;
};

/// `palpa.FingerSound`: the sound of a layout's transducers around a finger.
struct FingerSoundObject {
  std::shared_ptr<const LayoutObject> layout;
  setup::FocusingOptions drive;
  std::unique_ptr<setup::BodyInSound> finger;
  std::string name;
};

/// Adds the classes Drive and Field.
void add_sounds(py::module_& m);
/// Adds the class Layout, without what it computes.
py::class_<LayoutObject, std::shared_ptr<LayoutObject>> add_layout_class(py::module_& m);
/// Adds Layout.transfer.
void add_transfer(py::class_<LayoutObject, std::shared_ptr<LayoutObject>>& made);

/// The drive of these foci by a Python function, checked like the content of a file. The function gets the transfer
/// matrix (n, M) and the gains (n,), and returns a complex vector (M,). Needs the interpreter's lock.
array::Drive drive_by(const py::object& solver, const array::Layout& layout, std::span<const array::SlotFocus> foci,
                      const array::DriveOptions& options);

/// A Layout, or a name or file to be loaded.
std::shared_ptr<LayoutObject> layout_of(const char* name, const py::object& value);

}  // namespace palpa::python
