// Numbers of a command's JSON, by their paths: "langevin.peak_pa", "force_N.1", "fingers.count". The parts of a path
// are separated by dots. A part is the key of an object, the index of a list, or, at the end, what is made of a list of
// numbers: min, max, mean or sum; or of a list or an object: count, the number of its entries.
#pragma once

#include <string>
#include <vector>

namespace palpa::sweep {

/// What is wrong with a path; empty if it can be one.
std::string path_fault(const std::string& path);

/// A list or an object in the output of a command. No path may end there.
struct Structure {
  std::string path;   ///< with "#" for the index of a list: "fingers.#.foci_m"
  std::string entry;  ///< "0" of a list, a key of an object
};
/// What is wrong with a path that leads to one of them; empty if it does not.
std::string structure_fault(const std::string& path, const std::vector<Structure>& structures);

/// A case's results as JSON text, one for each path: a number, a text, true, false, or null if the JSON has no such
/// entry. Numbers keep their digits. `json` is the output of a command. Throws bad_usage naming the path that leads to
/// a list or an object, and says what would be right.
std::vector<std::string> results_of(const std::string& json, const std::vector<std::string>& paths);

/// What is wrong with a path that leads to nothing: the name that the JSON does not have, and the one that may be
/// meant. Empty if the path leads to a value, to null, or beyond the end of a list, which other cases may have.
std::string name_fault(const std::string& json, const std::string& path);

/// The command's JSON in one line and without its times, which differ between runs.
std::string without_times(const std::string& json);

}  // namespace palpa::sweep
