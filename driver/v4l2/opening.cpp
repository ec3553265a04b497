#include "driver/v4l2/opening.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::driver::v4l2 {
namespace {

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

}  // namespace

std::unique_ptr<Stream> open_camera(Kernel& kernel, const Description& description, const std::string& path,
                                    const Node& node, Known& known) {
  const Setup setup{kernel, description, path, known};
  return std::make_unique<Stream>(kernel, path, description.wanted, description.rig,
                                  [&](int fd) { setup.configure(fd, node); });
}

}  // namespace palpa::driver::v4l2
