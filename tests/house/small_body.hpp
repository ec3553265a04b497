// The smallest body that scatters sound.
#pragma once

#include <filesystem>
#include <string>

#include "support/files.hpp"

namespace palpa::test {

/// Writes a tetrahedron of 1 mm into the folder and returns the file's name.
inline std::string write_small_body(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "body.ply";
  write_text(file,
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
             "0 0 0\n0.001 0 0\n0 0.001 0\n0 0 0.001\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  return file;
}

}  // namespace palpa::test
