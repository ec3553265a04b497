#include "drawing/arrange.hpp"

#include <algorithm>
#include <cstddef>

namespace palpa::drawing {

Pixels halved(const Pixels& picture) {
  Pixels half{picture.width / 2, picture.height / 2, {}};
  half.rgba.resize(static_cast<std::size_t>(half.width) * half.height * 4);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    for (std::uint32_t x = 0; x < half.width; ++x) {
      for (std::size_t c = 0; c < 4; ++c) {
        const int sum = picture.at(2 * x, 2 * y)[c] + picture.at(2 * x + 1, 2 * y)[c] +
                        picture.at(2 * x, 2 * y + 1)[c] + picture.at(2 * x + 1, 2 * y + 1)[c];
        half.rgba[(static_cast<std::size_t>(y) * half.width + x) * 4 + c] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return half;
}

Pixels side_by_side(const std::vector<Pixels>& pictures, std::uint32_t columns) {
  std::uint32_t width = 0, height = 0;
  std::vector<std::size_t> tops;  // of rows
  for (std::size_t first = 0; first < pictures.size(); first += columns) {
    tops.push_back(height);
    std::uint32_t highest = 0;
    for (std::size_t i = first; i < std::min<std::size_t>(first + columns, pictures.size()); ++i) {
      width = std::max(width, pictures[i].width);
      highest = std::max(highest, pictures[i].height);
    }
    height += highest;
  }
  Pixels all{width * columns, height, {}};
  all.rgba.resize(static_cast<std::size_t>(all.width) * all.height * 4, 255);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::size_t left = i % columns * width, top = tops[i / columns];
    for (std::uint32_t y = 0; y < pictures[i].height; ++y) {
      std::copy_n(pictures[i].at(0, y), static_cast<std::size_t>(pictures[i].width) * 4,
                  all.rgba.begin() + static_cast<std::ptrdiff_t>(((top + y) * all.width + left) * 4));
    }
  }
  return all;
}

}  // namespace palpa::drawing
