#include "driver/v4l2/source.hpp"

#include <fmt/core.h>

#include <map>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "driver/cameras/source.hpp"
#include "driver/v4l2/opening.hpp"

namespace palpa::driver::v4l2 {
namespace {

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
