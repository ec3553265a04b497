#include "cli/study/in_python.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/error.hpp"

namespace palpa::cli {
namespace {

namespace fs = std::filesystem;

std::string python() {
  if (const char* named = std::getenv("PALPA_PYTHON"); named && *named) return named;
  std::error_code fault;
  for (const char* variable : {"VIRTUAL_ENV", "CONDA_PREFIX"}) {
    const char* folder = std::getenv(variable);
    if (!folder || !*folder) continue;
    if (const fs::path own = fs::path(folder) / "bin/python3"; fs::exists(own, fault)) return own.string();
  }
  return "/usr/bin/python3";
}

/// The package's program: beside the folder of this one, in a build, or where `cmake --install` puts it.
std::string program() {
  std::error_code fault;
  const fs::path above = fs::read_symlink("/proc/self/exe", fault).parent_path().parent_path();
  for (const char* folder : {"share/palpa/python", "python"}) {
    if (const fs::path file = above / folder / "palpa/study/__main__.py"; fs::exists(file, fault)) return file.string();
  }
  throw failure(fmt::format("{}/share/palpa/python is missing: it has the analysis in Python; install palpa again",
                            above.string()));
}

}  // namespace

void run_in_python(std::vector<std::string> words) {
  const std::string interpreter = python();
  words.insert(words.begin(), {interpreter, program()});
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(interpreter.c_str(), arguments.data());
  throw failure(fmt::format("{} cannot be started: {}: install Debian's python3, or let PALPA_PYTHON name a Python",
                            interpreter, std::strerror(errno)));
}

}  // namespace palpa::cli
