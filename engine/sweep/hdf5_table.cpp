#include "sweep/hdf5_table.hpp"

#include "base/error.hpp"

namespace palpa::sweep {

bool has_hdf5() {
  return false;
}

std::string to_hdf5(const Table&) {
  throw failure("this palpa was built without HDF5");
}

}  // namespace palpa::sweep
