#include "driver/v4l2/nodes.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <system_error>

#include "base/units.hpp"

namespace palpa::driver::v4l2 {
namespace {

namespace fs = std::filesystem;

std::string read_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

template <typename Number>
Number read_number(const fs::path& file, int base) {
  const std::string line = read_line(file);
  Number value = 0;
  std::from_chars(line.data(), line.data() + line.size(), value, base);
  return value;
}

/// "video12" -> 12; below 0 if it is not a video node.
int node_number(const std::string& name) {
  constexpr std::string_view stem = "video";
  if (!name.starts_with(stem)) return -1;
  return parse_whole<int>(std::string_view(name).substr(stem.size())).value_or(-1);
}

/// Fills in the values from the folders above a USB interface: the device, its bus, the bus's controller.
void read_usb(const fs::path& interface, Node& node) {
  std::error_code ignored;
  const fs::path device = interface.parent_path();
  if (!fs::exists(device / "idVendor", ignored)) return;
  node.interface = interface.filename().string();
  node.place = device.filename().string();
  node.serial = read_line(device / "serial");
  node.vendor = read_number<std::uint16_t>(device / "idVendor", 16);
  node.product = read_number<std::uint16_t>(device / "idProduct", 16);
  node.mbit_s = read_number<int>(device / "speed", 10);
  for (fs::path folder = device; folder.has_relative_path(); folder = folder.parent_path()) {
    const std::string name = folder.filename().string();
    if (!name.starts_with("usb")) continue;
    node.bus = name;
    node.controller = folder.parent_path().filename().string();
    return;
  }
}

}  // namespace

std::vector<Node> find_nodes(const fs::path& sys) {
  std::vector<std::pair<int, Node>> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(sys / "class" / "video4linux", ignored)) {
    const std::string name = entry.path().filename().string();
    const int number = node_number(name);
    if (number < 0) continue;
    Node node;
    node.path = "/dev/" + name;
    node.name = read_line(entry.path() / "name");
    node.index = read_number<unsigned>(entry.path() / "index", 10);
    const fs::path interface = fs::canonical(entry.path() / "device", ignored);
    if (!interface.empty()) read_usb(interface, node);
    found.emplace_back(number, std::move(node));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Node> nodes;
  nodes.reserve(found.size());
  for (auto& [number, node] : found)
    nodes.push_back(std::move(node));
  return nodes;
}

std::string find_again(const Identity& identity, std::span<const Node> nodes) {
  const Node& was = identity.node;
  if (was.path.empty() || was.place.empty()) return identity.path;
  const auto same_part = [&](const Node& node) {
    const auto number = [](const Node& n) {
      return n.interface.substr(std::min(n.interface.find(':'), n.interface.size()));
    };
    return node.vendor == was.vendor && node.product == was.product && node.index == was.index &&
           number(node) == number(was);
  };
  std::string elsewhere;
  for (const Node& node : nodes) {
    if (!same_part(node) || node.serial != was.serial) continue;
    // If two cameras share a serial number or have none, the port decides.
    if (node.place == was.place) return node.path;
    if (!was.serial.empty() && elsewhere.empty()) elsewhere = node.path;
  }
  return elsewhere;
}

}  // namespace palpa::driver::v4l2
