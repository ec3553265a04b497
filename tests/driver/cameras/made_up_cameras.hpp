// Emulated cameras behind the interface of system calls, on a clock that advances only while something waits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "driver/v4l2/kernel.hpp"
#include "driver/v4l2/offers.hpp"

namespace palpa::driver::v4l2::test {

struct MadeUpCamera {
  Node node;
  std::vector<Offer> offers;
  double rate_hz = 90, phase_s = 0;  ///< frame n is captured at phase_s + n / rate_hz, and
  double late_s = 0;                 ///< comes so long after that
  std::uint32_t padding = 0;         ///< bytes after each row
  std::uint32_t most_buffers = 8;
  bool monotonic = true;      ///< its stamps are on CLOCK_MONOTONIC
  bool metadata = false;      ///< it is a metadata node
  int refuses_to_open = 0;    ///< an errno
  int refuses_to_start = 0;   ///< an errno
  int refuses_format = 0;     ///< an errno
  bool frozen = false;        ///< gives no frames, and no error
  bool failing = false;       ///< gives each buffer back at once, empty and marked as faulty
  bool eager_einval = false;  ///< returns EINVAL once before ENODEV after it is unplugged
  std::set<std::uint64_t> skipped, cut, damaged, repeated;  ///< numbers of frames
  /// The answer to a control of its extension unit; -errno for an error. If it is empty, the camera has no such unit.
  std::function<int(std::uint8_t unit, std::uint8_t selector, std::uint8_t query, std::uint8_t* data,
                    std::uint16_t size)>
      extension;

  // State.
  bool streaming = false;
  std::uint64_t starts = 0;
  std::uint32_t width = 0, height = 0;
  double stamp_s = 0;      ///< of the previous frame
  std::uint64_t next = 0;  ///< number of the next frame
  std::vector<std::vector<std::byte>> buffers;
  std::vector<std::uint32_t> queued;  ///< oldest first, like those below
  struct Filled {
    std::uint32_t buffer, bytes, flags;
    double time_s;
  };
  std::vector<Filled> filled;
};

/// The emulated machine. It outlives the Kernel that uses it, which the source owns.
struct Machine {
  double now_s = 100;
  std::uint64_t calls = 0;
  int open_descriptors = 0, mapped = 0;
  double beside_s = 0;                                                          ///< duration of background tasks
  std::map<std::string, std::shared_ptr<MadeUpCamera>> plugged;                 ///< by path
  std::map<std::string, std::string> links;                                     ///< other names of nodes
  std::map<int, std::pair<std::string, std::shared_ptr<MadeUpCamera>>> opened;  ///< by descriptor
  std::vector<std::pair<double, std::function<void()>>> later;                  ///< events and their times, in order

  std::shared_ptr<MadeUpCamera> plug(const std::string& path, const std::string& serial);
  void plug(const std::string& path, std::shared_ptr<MadeUpCamera> camera);
  void unplug(const std::string& path) { plugged.erase(path); }
  void at(double time_s, std::function<void()> what) { later.emplace_back(time_s, std::move(what)); }
  /// Lets frames come and events happen until then.
  void pass(double until_s);
  std::unique_ptr<Kernel> kernel();
};

}  // namespace palpa::driver::v4l2::test
