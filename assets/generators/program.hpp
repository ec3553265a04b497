// The common part of every generator's main(): reads one argument, runs, turns an error into one line and an exit code.
#pragma once

#include <cstdio>
#include <exception>
#include <string>

#include "base/error.hpp"

namespace palpa::assets {

/// The program's only argument. Throws bad_usage that names it as `what`.
inline std::string only_argument(int argc, char** argv, const std::string& what) {
  if (argc != 2 || argv[1][0] == '-') throw bad_usage("usage: " + std::string(argv[0]) + ' ' + what);
  return argv[1];
}

/// Runs `work` and returns the exit code; an error is one line on stderr.
template <class Work>
int run_program(const Work& work) {
  try {
    work();
    return static_cast<int>(Exit::ok);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(Exit::failed);
  }
}

}  // namespace palpa::assets
