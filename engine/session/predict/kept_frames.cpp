#include "session/predict/kept_frames.hpp"

#include <algorithm>

#include "touch/types.hpp"

namespace palpa::session {
namespace {

/// Calls `work` with the first pixel and the number of pixels of each row of a window.
template <typename Work>
void each_row(const sensing::Crop& window, std::uint32_t width, Work work) {
  const std::uint32_t columns = std::min(window.blocks_per_row * sensing::block_pixels, width - window.first_column);
  for (std::uint32_t row = window.first_row; row < window.first_row + window.rows; ++row)
    work(std::size_t{row} * width + window.first_column, columns);
}

}  // namespace

KeptFrames::KeptFrames(const CameraView& view) {
  images_.resize(view.cameras.size());
  for (std::size_t c = 0; c < view.cameras.size(); ++c)
    images_[c].depth.assign(sensing::pixel_count(view.cameras[c]), 0);
  windows_.reserve(view.cameras.size() * touch::max_fingers);
  crops_.reserve(view.cameras.size());
}

void KeptFrames::keep(const CameraView& view, std::span<const sensing::DepthFrame> images, std::span<const Box> boxes) {
  for (const sensing::Crop& window : windows_) {
    std::vector<std::uint16_t>& depth = images_[window.camera].depth;
    each_row(window, view.cameras[window.camera].width, [&](std::size_t first, std::uint32_t count) {
      std::fill_n(depth.begin() + static_cast<std::ptrdiff_t>(first), count, 0);
    });
  }
  windows_.clear();
  if (images.size() != images_.size()) return;
  for (const Box& box : boxes) {
    sensing::plan_crops(view.cameras, view.tables, box, crops_);
    windows_.insert(windows_.end(), crops_.begin(), crops_.end());
  }
  for (const sensing::Crop& window : windows_) {
    const std::vector<std::uint16_t>& from = images[window.camera].depth;
    std::vector<std::uint16_t>& depth = images_[window.camera].depth;
    if (from.size() != depth.size()) continue;
    each_row(window, view.cameras[window.camera].width, [&](std::size_t first, std::uint32_t count) {
      const auto at = static_cast<std::ptrdiff_t>(first);
      std::copy_n(from.begin() + at, count, depth.begin() + at);
    });
  }
}

}  // namespace palpa::session
