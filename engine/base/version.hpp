// Which palpa this is.
#pragma once

#include <string>

namespace palpa {

/// "0.2.0".
std::string version();
/// The commit that it was built from, 12 hexadecimal digits; empty if it was built from an archive.
std::string commit();
/// "0.2.0 (0123456789ab)": distinguishes programs that may compute different results.
std::string version_and_commit();
/// Whether it was built with an optional library, for example "SDL2" or "V-HACD".
bool built_with(const std::string& feature);
/// What `PROGRAM --version` prints: version, commit, compiler, optional features, and the versions of the libraries
/// that it was built with; a line each.
std::string about_program(const std::string& program);

}  // namespace palpa
