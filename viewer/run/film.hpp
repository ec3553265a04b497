// Writes a sequence of pictures as files in a folder: 000000.png and so on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "drawing/png.hpp"

namespace palpa::viewer {

class Film {
 public:
  /// Makes the folder. Without a name, it takes no pictures. Throws failure.
  explicit Film(const std::string& folder);
  bool wanted() const { return !folder_.empty(); }
  /// Pictures may have different sizes. Throws failure if one cannot be written whole.
  void add(const drawing::Pixels& pixels);

 private:
  std::filesystem::path folder_;
  std::uint64_t next_ = 0;
};

}  // namespace palpa::viewer
