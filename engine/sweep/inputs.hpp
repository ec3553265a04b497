// The files that the cases of a plan read, and their contents' digests.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sweep/plan.hpp"

namespace palpa::sweep {

struct Input {
  std::string name;  ///< as the plan, or a file that the plan names, has it
  std::string path;
  std::string sha256;
  std::uint64_t bytes = 0;
};

class Inputs {
 public:
  /// Reads every file that an option of any case names, and the files that these name: the buffers of a glTF model, the
  /// layout and the masks of a rig. Throws bad_input naming the plan's line and the file for one that is missing or
  /// cannot be read.
  explicit Inputs(const Plan& plan);

  /// Each file once, in the order of the plan.
  const std::vector<Input>& all() const { return files_; }
  /// The settings with the paths of files instead of their names in the plan.
  std::vector<Setting> resolved(std::vector<Setting> settings) const;
  /// The settings as text in which the contents of files replace their names: equal for cases that compute the same.
  std::string canonical(const std::vector<Setting>& settings) const;

 private:
  void add(const Plan& plan, const Setting& setting);
  std::string add_file(const std::string& name, const std::string& path);

  const Plan* plan_;
  std::vector<Input> files_;
  std::map<std::string, std::size_t> by_path_;                         ///< into files_
  std::map<std::string, std::map<std::string, std::string>> digests_;  ///< of option and value: all of its contents
  std::map<std::string, std::map<std::string, std::string>> paths_;    ///< of option and value
};

}  // namespace palpa::sweep
