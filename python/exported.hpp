// palpa.Export.
#pragma once

#include <vector>

#include "setup/tasks/export.hpp"

namespace palpa::python {

struct ExportObject {
  setup::ExportResult result;
  std::vector<setup::FocusRow> rows;
};

}  // namespace palpa::python
