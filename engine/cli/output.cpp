#include "cli/output.hpp"

#include "base/error.hpp"

namespace palpa::cli {

void refuse_two_on_stdout(const std::string& json, const std::string& csv) {
  if (json == "-" && csv == "-") throw bad_usage("--json - and --csv - would mix on stdout: give one of them a file");
}

}  // namespace palpa::cli
