// Starts the analysis of studies in Python (python/palpa/study).
#pragma once

#include <string>
#include <vector>

namespace palpa::cli {

/// Python takes the place of this process, with these words, and its exit code is that of the command. It is the one
/// that PALPA_PYTHON names, else that of the environment that is active (VIRTUAL_ENV, CONDA_PREFIX), else the system's.
/// Throws failure() naming what to install.
[[noreturn]] void run_in_python(std::vector<std::string> words);

}  // namespace palpa::cli
