#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <complex>
#include <vector>

#include "array/drive.hpp"
#include "array/field/free_field.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "layout.hpp"
#include "layout_doc.hpp"
#include "running.hpp"
#include "setup/options/options.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"

namespace palpa::python {
namespace {

/// level D(angle) exp(i k d) / max(d, radius), shape (n, M).
py::array transfer_matrix(const char* name, const array::Layout& layout, const std::vector<Vec3>& places,
                          const array::DriveOptions& options) {
  const std::size_t transducers = layout.transducers.size();
  constexpr std::size_t most_entries = std::size_t{1} << 28;
  if (places.size() * transducers > most_entries) {
    throw bad_usage(fmt::format("{}: {} points times {} transducers are more than {} entries; give fewer at a time",
                                name, places.size(), transducers, most_entries));
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!array::drivable({.position = places[i]}))
      throw bad_usage(fmt::format("{}: row {} is farther than 100 m from the array", name, i));
  }
  py::array_t<std::complex<double>> matrix(
      {static_cast<py::ssize_t>(places.size()), static_cast<py::ssize_t>(transducers)});
  std::complex<double>* const to = matrix.mutable_data();
  const auto fill = [&] {
    array::FreeField field;
    field.set(layout, options.medium, options.directivity);
    array::Columns columns;
    std::vector<array::FocusSource> sources;
    constexpr std::size_t block = 64;
    for (std::size_t begin = 0; begin < places.size(); begin += block) {
      stop_if_cancelled(cancel_flag());
      const std::size_t count = std::min(block, places.size() - begin);
      sources.clear();
      for (std::size_t i = 0; i < count; ++i)
        sources.push_back({places[begin + i], 1, 1});
      field.fill(sources, array::Weighting::uniform, columns);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t t = 0; t < transducers; ++t)
          to[(begin + i) * transducers + t] = layout.source_level_pa_m * columns.transfer(t * count + i);
      }
    }
    return true;
  };
  constexpr std::size_t many_entries = std::size_t{1} << 22;
  places.size() * transducers < many_entries ? unlocked(fill) : cancellable(fill);
  return sealed(std::move(matrix));
}

}  // namespace

array::Drive drive_by(const py::object& solver, const array::Layout& layout, std::span<const array::SlotFocus> foci,
                      const array::DriveOptions& options) {
  std::vector<Vec3> places;
  std::vector<double> gains;
  for (const array::SlotFocus& focus : foci) {
    places.push_back(focus.position);
    gains.push_back(double{focus.gain});
  }
  if (places.empty()) return array::Drive(layout.transducers.size(), {0, 0});
  const py::array matrix = transfer_matrix("foci", layout, places, options);
  const py::tuple arguments = py::make_tuple(matrix, copied(std::span<const double>(gains)));
  return drive_of_layout("solver", call_python(solver, arguments), layout);
}

namespace {

constinit DeclaredOnce<setup::FocusingOptions> transfer_options("Layout.transfer", setup::add_propagation_options);

py::array transfer(const std::shared_ptr<LayoutObject>& self, const py::object& points, const py::kwargs& kwargs) {
  refuse_fork();
  const setup::FocusingOptions o = transfer_options().read(kwargs);
  const array::DriveOptions options = setup::drive_options(o, self->layout, setup::Solving::once);
  refuse_other_frame("points", points, *self);
  const std::vector<Vec3> places = points_of("points", points);
  return transfer_matrix("points", self->layout, places, options);
}

}  // namespace

void add_transfer(py::class_<LayoutObject, std::shared_ptr<LayoutObject>>& made) {
  const std::string text = transfer_options().documented(transfer_doc);
  made.def("transfer", &transfer, py::arg("points"), text.c_str());
}

}  // namespace palpa::python
