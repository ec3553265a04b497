#include "driver/v4l2/doctor.hpp"

#include <fmt/core.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "driver/v4l2/d400.hpp"
#include "driver/v4l2/offers.hpp"

namespace palpa::driver::v4l2 {
namespace {

constexpr double coarse_m = 0.5e-3;
constexpr double stream_mb_s = 848 * 480 * 2 * 90 / 1e6;
constexpr double usb3_mbit_s = 5000;

struct Seen {
  Node node;
  int refusal = 0;  ///< errno; 0: it could be opened
  std::vector<Offer> offers;
  std::optional<double> depth_unit_m;
  bool gives_depth() const { return !cameras::list_sizes(offers, V4L2_PIX_FMT_Z16).empty(); }
};

Seen look_at(Kernel& kernel, const Node& node) {
  Seen seen{.node = node};
  const int fd = kernel.open(node.path);
  if (fd < 0) {
    seen.refusal = -fd;
    return seen;
  }
  seen.offers = list_offers(kernel, fd);
  if (seen.gives_depth() && d400::is_realsense(node)) {
    try {
      seen.depth_unit_m = d400::read_depth_unit(kernel, fd);
    } catch (const Error&) {
      // It is busy, or not a D400, so this is not known.
    }
  }
  kernel.close(fd);
  return seen;
}

void add(std::string& advice, const std::string& more) {
  advice += (advice.empty() ? "" : "; ") + more;
}

/// Other depth cameras on the same controller.
std::string sharing(const Seen& seen, const std::vector<Seen>& all) {
  std::string others;
  for (const Seen& other : all) {
    const bool shares =
        other.gives_depth() && other.node.place != seen.node.place && other.node.controller == seen.node.controller;
    if (shares) others += (others.empty() ? "" : ", ") + other.node.path;
  }
  return others;
}

std::string advice_for(const Seen& seen, const std::vector<Seen>& all) {
  std::string advice;
  if (seen.refusal != 0) {
    return seen.refusal == EACCES ? no_permission : std::generic_category().message(seen.refusal);
  }
  if (!seen.gives_depth()) return advice;
  add(advice, "depth: --source v4l2:" + seen.node.path);
  if (seen.depth_unit_m && *seen.depth_unit_m >= coarse_m) {
    add(advice, fmt::format("its depth unit is {:g} mm, which is coarse for a shell of 1.5 mm: with depth_unit_m = "
                            "0.0001 in the rig, palpa sets 0.1 mm",
                            *seen.depth_unit_m * 1e3));
  }
  if (seen.node.mbit_s > 0 && seen.node.mbit_s < usb3_mbit_s)
    add(advice, fmt::format("runs at {:g} Mbit/s, too slow for 848x480 at 90 Hz: use a USB 3 port and cable",
                            seen.node.mbit_s));
  if (seen.node.controller.empty()) return advice;
  if (const std::string others = sharing(seen, all); !others.empty()) {
    add(advice, fmt::format("shares the USB controller {} with {}, {:.0f} MB/s each at 848x480 and 90 Hz: if frames "
                            "are missing, plug them into ports of different controllers",
                            seen.node.controller, others, stream_mb_s));
  }
  return advice;
}

cli::DoctorItem describe(const Seen& seen, const std::vector<Seen>& all) {
  const Node& node = seen.node;
  cli::DoctorItem item;
  item.title = node.name.empty() ? node.path : fmt::format("{} {}", node.path, node.name);
  item.ok = seen.refusal == 0;
  item.advice = advice_for(seen, all);
  item.facts = {{"node", node.path}, {"name", node.name}, {"usable", item.ok}};
  if (!node.place.empty()) {
    item.facts.push_back({"place", node.place});
    item.facts.push_back({"serial", node.serial});
    item.facts.push_back({"controller", node.controller});
  }
  if (item.ok) item.facts.push_back({"formats", list_formats(seen.offers)});
  if (seen.depth_unit_m)
    item.facts.push_back({"depth_unit_um", static_cast<std::int64_t>(std::llround(*seen.depth_unit_m * 1e6))});
  return item;
}

}  // namespace

std::vector<cli::DoctorItem> describe_nodes(Kernel& kernel) {
  std::vector<Seen> all;
  for (const Node& node : kernel.nodes())
    all.push_back(look_at(kernel, node));
  std::vector<cli::DoctorItem> items;
  items.reserve(all.size());
  for (const Seen& seen : all)
    items.push_back(describe(seen, all));
  return items;
}

}  // namespace palpa::driver::v4l2
