// A table of results as HDF5, where palpa was built with its library.
#pragma once

#include <string>

#include "sweep/gather.hpp"

namespace palpa::sweep {

bool has_hdf5();

/// One dataset for each column of the CSV, named after it: numbers as doubles, nan for a missing one; everything else
/// as texts. Returns the file's bytes; the same table gives the same ones. Throws failure() without HDF5.
std::string to_hdf5(const Table& table);

}  // namespace palpa::sweep
