#include "driver/realsense/source.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/error.hpp"
#include "driver/cameras/source.hpp"
#include "driver/realsense/device.hpp"

namespace palpa::driver::realsense {
namespace {

/// The rig says which camera stands where, so if there are several, each must be named.
std::string find_only(Sdk& sdk) {
  const std::vector<std::string> there = sdk.serials();
  if (there.empty()) {
    throw bad_input("realsense:any", "librealsense2 finds no camera; palpa doctor says what is plugged in");
  }
  if (there.size() > 1) {
    throw bad_usage(fmt::format(
        "source realsense: {} cameras are plugged in; name the rig's cameras, in the rig's order: realsense:{}",
        there.size(), fmt::join(there, ",")));
  }
  return there.front();
}

}  // namespace

std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<cameras::Host> host, const std::shared_ptr<Sdk>& sdk,
                                                   std::vector<sensing::Camera> cameras, const std::string& argument,
                                                   const std::string& rig) {
  std::vector<std::string> serials = cameras::parse_names(argument, "realsense", "SERIAL or realsense:any");
  cameras::check_count(serials.size(), cameras.size(), "realsense", rig);
  if (serials.size() == 1 && serials[0] == "any") serials[0] = find_only(*sdk);
  std::vector<std::unique_ptr<cameras::Device>> devices;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    devices.push_back(std::make_unique<Device>(*host, sdk, serials[c], cameras[c], rig));
  return cameras::open_cameras(std::move(host), std::move(cameras), std::move(devices), rig);
}

session::SourceKind source_kind() {
  return {"realsense", "realsense:SERIAL[,SERIAL...] or realsense:any: the same cameras through the librealsense2 SDK",
          [](const std::string& argument, const session::SourceSetting& setting) {
            return open_cameras(std::make_unique<cameras::Host>(), make_sdk(), setting.cameras, argument, setting.rig);
          }};
}

}  // namespace palpa::driver::realsense
