#include "driver/v4l2/source.hpp"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "driver/cameras/source.hpp"
#include "driver/v4l2/d400.hpp"
#include "driver/v4l2/stream.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::v4l2 {
namespace {

// ---- a camera is made ready: opened, set up as the rig says if it is a RealSense, and streaming

/// What the command line and the rig say about a camera.
struct Description {
  std::string name;  ///< the rig's
  std::string path;  ///< as on the command line
  Wanted wanted;
  std::string rig;  ///< its file, for messages
  double depth_unit_m = 0.001;
  sensing::DeviceSetting setting{};
};

/// What a camera has reported about itself. One that comes back must report the same.
struct Known {
  std::optional<cameras::Lens> lens;  ///< of its own calibration, if the setting asks for that
  bool unit_read = false;             ///< after that, a camera that does not answer is not trusted
  bool trusted_said = false;
};

constexpr double micrometre = 1e-6;

/// One camera while it is set up.
struct Setup {
  Kernel& kernel;
  const Description& description;
  const std::string& path;
  Known& known;

  void configure(int fd, const Node& node) const {
    const sensing::DeviceSetting& setting = description.setting;
    if (!d400::is_realsense(node)) {
      if (setting.own_lens || setting.exposure_s || setting.preset) {
        throw bad_input(
            path,
            fmt::format(
                "is not a RealSense on USB: calibration = \"device\", exposure_s and hardware_preset of {} need one",
                description.rig));
      }
      return;
    }
    try {
      if (setting.preset) d400::write_hardware_preset(kernel, fd, *setting.preset);
      if (setting.exposure_s) d400::write_exposure(kernel, fd, *setting.exposure_s);
      if (setting.own_lens) read_lens(fd);
    } catch (const Error& error) {
      throw bad_input(path, error.what());
    }
    set_depth_unit(fd);
  }

 private:
  void read_lens(int fd) const {
    const cameras::Lens lens = d400::read_lens(kernel, fd, description.wanted.width, description.wanted.height);
    if (known.lens && lens != *known.lens) {
      throw failure(
          "its lens has changed: this is not the camera that was here before, or it was recalibrated; plug the first "
          "camera in again, or restart palpa");
    }
    known.lens = lens;
  }

  void set_depth_unit(int fd) const {
    const double wanted_m = description.depth_unit_m, wanted_um = wanted_m / micrometre;
    const bool whole = std::round(wanted_um) >= 1 && std::abs(wanted_um - std::round(wanted_um)) <= 1e-6;
    const auto is_wanted = [&](double unit_m) { return std::lround(unit_m / micrometre) == std::lround(wanted_um); };
    double unit_m = 0;
    try {
      unit_m = d400::read_depth_unit(kernel, fd);
      if (!whole) {
        throw bad_input(path,
                        fmt::format("keeps its depth unit in whole micrometres, but depth_unit_m of {} is {:g} "
                                    "micrometres; set depth_unit_m = {:g}",
                                    description.rig, wanted_um, std::fmax(1, std::round(wanted_um)) * micrometre));
      }
      if (!is_wanted(unit_m)) {
        d400::write_depth_unit(kernel, fd, wanted_m);
        unit_m = d400::read_depth_unit(kernel, fd);
      }
    } catch (const Error& error) {
      if (unit_m != 0 || known.unit_read) throw bad_input(path, error.what());
      if (!std::exchange(known.trusted_said, true)) {
        log::warning(fmt::format("{}: {}; palpa assumes a depth unit of {:g} mm, as {} says", path, error.what(),
                                 wanted_m * 1e3, description.rig));
      }
      return;
    }
    known.unit_read = true;
    // With depths ten times too large, the hand would be elsewhere.
    if (!is_wanted(unit_m)) {
      throw bad_input(path, fmt::format("keeps its depth unit of {:g} mm; set depth_unit_m = {:g} in {}", unit_m * 1e3,
                                        unit_m, description.rig));
    }
  }
};

/// `node` is what sysfs knows of `path`. Throws bad_input as Stream does, if the camera keeps another depth unit than
/// the rig says or cannot keep that one, and if its lens is not the known one. May take seconds if the device does not
/// answer.
std::unique_ptr<Stream> open_camera(Kernel& kernel, const Description& description, const std::string& path,
                                    const Node& node, Known& known) {
  const Setup setup{kernel, description, path, known};
  return std::make_unique<Stream>(kernel, path, description.wanted, description.rig,
                                  [&](int fd) { setup.configure(fd, node); });
}

class Camera final : public cameras::Device {
 public:
  Camera(Kernel& kernel, Description description)
      : kernel_(kernel), description_(std::move(description)), path_(description_.path) {
    identity_.path = path_;
    const std::string real = kernel_.resolve(path_);
    for (const Node& node : kernel_.nodes()) {
      if (node.path == real) identity_.node = node;
    }
  }

  const std::string& address() const override { return path_; }
  const std::optional<cameras::Lens>& lens() const override { return known_.lens; }
  std::unique_ptr<cameras::Stream> open() override {
    return open_camera(kernel_, description_, path_, identity_.node, known_);
  }
  std::unique_ptr<cameras::Stream> open_again() override {
    const std::string path = find_again(identity_, kernel_.nodes());
    if (path.empty()) return nullptr;
    auto stream = open_camera(kernel_, description_, path, identity_.node, known_);
    path_ = path;
    return stream;
  }

 private:
  Kernel& kernel_;
  const Description description_;
  Identity identity_;
  std::string path_;  ///< the node's path now
  Known known_;
};

/// One camera has several names: /dev/videoN and the links in /dev/v4l/by-id.
void refuse_twice(Kernel& kernel, const std::vector<std::string>& nodes) {
  std::map<std::string, std::string> named;
  for (const std::string& node : nodes) {
    const auto [before, first] = named.emplace(kernel.resolve(node), node);
    if (first) continue;
    throw bad_usage(
        fmt::format("source v4l2 names one camera twice: {} and {} are both {}; name each camera of the rig once",
                    before->second, node, before->first));
  }
}

}  // namespace

std::vector<std::string> parse_nodes(const std::string& argument) {
  return cameras::parse_names(argument, "v4l2", "/dev/video0 or v4l2:/dev/video0,/dev/video2");
}

std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<Kernel> kernel, std::vector<sensing::Camera> cameras,
                                                   const std::vector<std::string>& nodes, const std::string& rig) {
  cameras::check_count(nodes.size(), cameras.size(), "v4l2", rig);
  refuse_twice(*kernel, nodes);
  std::vector<std::unique_ptr<cameras::Device>> devices;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const sensing::Camera& camera = cameras[c];
    devices.push_back(
        std::make_unique<Camera>(*kernel, Description{.name = camera.name,
                                                      .path = nodes[c],
                                                      .wanted = {camera.width, camera.height, camera.rate_hz},
                                                      .rig = rig,
                                                      .depth_unit_m = camera.depth_unit_m,
                                                      .setting = camera.device}));
  }
  return cameras::open_cameras(std::move(kernel), std::move(cameras), std::move(devices), rig);
}

session::SourceKind source_kind() {
  return {"v4l2", "v4l2:/dev/videoN[,/dev/videoM...]: RealSense D400 depth cameras, in the order of the rig",
          [](const std::string& argument, const session::SourceSetting& setting) {
            return open_cameras(make_kernel(), setting.cameras, parse_nodes(argument), setting.rig);
          }};
}

}  // namespace palpa::driver::v4l2
