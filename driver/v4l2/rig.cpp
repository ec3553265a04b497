#include "driver/v4l2/rig.hpp"

#include <fmt/core.h>
#include <linux/videodev2.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <system_error>
#include <tuple>
#include <vector>

#include "base/error.hpp"
#include "driver/v4l2/d400.hpp"
#include "driver/v4l2/offers.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::v4l2 {
namespace {

constexpr std::uint32_t default_width = 848, default_height = 480;
constexpr double default_unit_m = 1e-4, nearest_m = 0.28;
constexpr double guessed_view = 65 * std::numbers::pi / 180;

/// 848x480 if available, else the largest size; the highest of its rates.
std::optional<Offer> best_of(const std::vector<Offer>& offers) {
  const auto rank = [](const Offer& offer) {
    const bool usual = offer.width == default_width && offer.height == default_height;
    return std::tuple(usual, std::uint64_t{offer.width} * offer.height, offer.rate_hz);
  };
  std::optional<Offer> best;
  for (const Offer& offer : offers) {
    const bool depth = offer.format == V4L2_PIX_FMT_Z16 && offer.width > 0 && offer.height > 0;
    if (depth && (!best || rank(offer) > rank(*best))) best = offer;
  }
  return best;
}

void guess_lens(sensing::Camera& camera) {
  camera.fx = camera.fy = std::round(camera.width / 2.0 / std::tan(guessed_view / 2));
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
}

/// Describes what is known of the lens, as text.
std::string read_lens(Kernel& kernel, int fd, const Node& node, sensing::Camera& camera) {
  guess_lens(camera);
  std::string why = "only a RealSense reports them";
  if (d400::is_realsense(node)) {
    try {
      const cameras::Lens lens = d400::read_lens(kernel, fd, camera.width, camera.height);
      camera.fx = lens.fx;
      camera.fy = lens.fy;
      camera.cx = lens.cx;
      camera.cy = lens.cy;
      camera.distortion = lens.distortion;
      camera.device.own_lens = true;
      return "the lens is that of the camera's own calibration";
    } catch (const Error& error) {
      why = error.what();
    }
  }
  return fmt::format("fx, fy, cx and cy are a guess ({}): replace them by those of a calibration", why);
}

}  // namespace

cli::CamerasThere cameras_there(Kernel& kernel) {
  cli::CamerasThere there{.source = "v4l2:", .cameras = {}, .problem = {}};
  for (const Node& node : kernel.nodes()) {
    const int fd = kernel.open(node.path);
    if (fd < 0) {
      there.problem +=
          fmt::format("{}{}: {}", there.problem.empty() ? "" : "; ", node.path, std::generic_category().message(-fd));
      continue;
    }
    if (const std::optional<Offer> offer = best_of(list_offers(kernel, fd))) {
      sensing::Camera camera;
      camera.name = node.serial.empty() ? fmt::format("camera {}", there.cameras.size() + 1) : node.serial;
      camera.width = offer->width;
      camera.height = offer->height;
      camera.rate_hz = offer->rate_hz;
      const bool realsense = d400::is_realsense(node);
      if (realsense) camera.depth_unit_m = default_unit_m;  // palpa sets it
      if (realsense) camera.min_range_m = nearest_m;
      std::string note = fmt::format("{}{}{}: {}", node.path, node.name.empty() ? "" : " ", node.name,
                                     read_lens(kernel, fd, node, camera));
      if (!realsense) note += "; depth_unit_m is a guess, too";
      there.source += (there.cameras.empty() ? "" : ",") + node.path;
      there.cameras.push_back({camera, note});
    }
    kernel.close(fd);
  }
  return there;
}

}  // namespace palpa::driver::v4l2
