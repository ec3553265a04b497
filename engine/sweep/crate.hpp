// The provenance of gathered results: a Research Object Crate, which Zenodo and WorkflowHub read
// (https://w3id.org/ro/crate/1.1). It is the folder that the results are in, with these files beside them:
//   ro-crate-metadata.json   the plan, the inputs with their SHA-256, palpa's version, the devices, the times
//   plan.toml                the plan; in the plan's own folder there is no copy of it, because it is there already
//   provenance.csv           of each case: when, where and how it ended
#pragma once

#include <string>
#include <vector>

#include "sweep/gather.hpp"
#include "sweep/inputs.hpp"
#include "sweep/plan.hpp"

namespace palpa::sweep {

/// `file`, and the files that write_crate() writes for results in it.
std::vector<std::string> files_of_crate(const std::string& plan_file, const std::string& file);

/// Throws failure() if the crate of `file` would replace other files: if there is a crate in its folder but no such
/// file, so the crate is that of other results; and if there is a file of a crate but no crate, unless the folder is
/// `out`, the sweep's own.
void refuse_other_crate(const std::string& plan_file, const std::string& out, const std::string& file);

/// Call it when `file` is written; `results` are its bytes. Throws failure() naming a file that cannot be written.
void write_crate(const Plan& plan, const Inputs& inputs, const Table& table, const std::string& file,
                 const std::string& results);

}  // namespace palpa::sweep
