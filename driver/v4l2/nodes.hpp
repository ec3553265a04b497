// The video nodes that the kernel has made for cameras, and which device is behind each, according to sysfs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpa::driver::v4l2 {

/// One /dev/videoN. What sysfs does not say is empty or 0.
struct Node {
  std::string path;        ///< "/dev/video0"
  std::string name;        ///< as its driver calls it
  unsigned index = 0;      ///< among the nodes of one interface: 0 is the stream, 1 its metadata
  std::string interface;   ///< of USB: "2-1.4:1.0"
  std::string place;       ///< of USB, the port it is plugged into: "2-1.4"
  std::string controller;  ///< of the host: "0000:00:14.0"
  std::string bus;         ///< of USB, one per speed and controller: "usb2"
  std::string serial;      ///< the device's own
  std::uint16_t vendor = 0, product = 0;
  double mbit_s = 0;  ///< the device's speed: 480, 5000, ...
};

/// All nodes, by their number. `sys` is /sys, or a test's own; nodes are named as if in /dev.
std::vector<Node> find_nodes(const std::filesystem::path& sys);

/// The data by which a node is recognised when its device was unplugged and comes back, perhaps with another number and
/// on another port.
struct Identity {
  std::string path;  ///< as on the command line
  Node node;         ///< as it was when it was opened; its path is empty if sysfs does not know it
};

/// The path of the node now: the node with the same serial number (without one: on the same port) and the same place in
/// its device. Empty if there is none. If sysfs did not know the node, the path itself.
std::string find_again(const Identity& identity, std::span<const Node> nodes);

}  // namespace palpa::driver::v4l2
