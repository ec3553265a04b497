// The fingertips that a person has labelled in the recording of two hands (depth-hand-kinect1-candescent).
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace palpa::test {

/// A place in a picture, in pixels.
struct Pixel {
  double u, v;
};

struct HandTip {
  int hand;  ///< 1: left, 2: right
  Pixel pixel;
  double z;  ///< metres
};

inline std::vector<HandTip> read_tips(const std::filesystem::path& file) {
  std::vector<HandTip> tips;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');)
      cells.push_back(cell);
    if (cells.at(1) == "tip")
      tips.push_back({std::stoi(cells[0]), {std::stod(cells[2]), std::stod(cells[3])}, std::stod(cells[4]) / 1000});
  }
  return tips;
}

}  // namespace palpa::test
