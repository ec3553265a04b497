#include "driver/autd3/emulated/server.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpa::driver::autd3 {
namespace {

constexpr std::uint8_t ask_geometry = 0x01, ask_new_geometry = 0x02, ask_send = 0x03, ask_read = 0x04, ask_close = 0x05,
                       ask_hello = 0x10;
constexpr std::size_t hello_size = 14, geometry_head = 5, pose_size = 28;

}  // namespace

void EmulatedServer::client_came() {
  request_.clear();
  greeted_ = configured_ = said_goodbye_ = false;
}

void EmulatedServer::client_left(double now_s) {
  if (!request_.empty())
    violations_.add(now_s, fmt::format("disconnected after {} bytes of a request", request_.size()));
  if (!said_goodbye_) violations_.add(now_s, "disconnected without a goodbye");
  if (configured_ && !silent(now_s)) violations_.add(now_s, "disconnected while the devices sounded");
  client_came();
}

/// The size of the request that has begun, as far as it is known.
std::size_t EmulatedServer::needed() const {
  switch (request_[0]) {
    case ask_hello:
      return hello_size;
    case ask_geometry:
    case ask_new_geometry: {
      if (request_.size() < geometry_head) return geometry_head;
      std::uint32_t count = 0;
      std::memcpy(&count, request_.data() + 1, sizeof count);
      return geometry_head + pose_size * std::min<std::size_t>(count, devices_.size() + 1);
    }
    case ask_send:
      return 1 + EmulatedDevice::message_size * devices_.size();
    default:
      return 1;
  }
}

bool EmulatedServer::take(double now_s, std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out) {
  for (std::size_t at = 0; at < bytes.size();) {
    if (request_.empty()) {
      request_.push_back(bytes[at++]);
    } else {
      const std::size_t more = std::min(needed() - request_.size(), bytes.size() - at);
      request_.insert(request_.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                      bytes.begin() + static_cast<std::ptrdiff_t>(at + more));
      at += more;
    }
    if (request_.size() < needed()) continue;
    const bool goes_on = answer_request(now_s, out);
    request_.clear();
    if (!goes_on) return false;
  }
  return true;
}

bool EmulatedServer::refuse(double now_s, const std::string& what, std::vector<std::uint8_t>& out) {
  violations_.add(now_s, what);
  out.push_back(0xff);
  for (int byte = 0; byte < 4; ++byte)
    out.push_back(static_cast<std::uint8_t>(what.size() >> (8 * byte)));
  out.insert(out.end(), what.begin(), what.end());
  return false;
}

bool EmulatedServer::answer_request(double now_s, std::vector<std::uint8_t>& out) {
  const std::uint8_t kind = request_[0];
  if (kind == ask_hello) {
    if (greeted_) return refuse(now_s, "a second hello", out);
    const std::string_view magic(reinterpret_cast<const char*>(request_.data()) + 3, 11);
    if (request_[1] != 1 || request_[2] != 0 || magic != "AUTD3REMOTE")
      return refuse(now_s, "a hello of another protocol or version", out);
    greeted_ = true;
    out.push_back(0);
    return true;
  }
  if (!greeted_) return refuse(now_s, fmt::format("request 0x{:02x} before the hello", kind), out);
  if (kind == ask_geometry || kind == ask_new_geometry) {
    if (configured_ != (kind == ask_new_geometry)) return refuse(now_s, "a geometry out of order", out);
    std::uint32_t count = 0;
    std::memcpy(&count, request_.data() + 1, sizeof count);
    if (count != devices_.size())
      return refuse(now_s, fmt::format("a geometry of {} devices, but there are {}", count, devices_.size()), out);
    poses_.resize(count);
    for (std::size_t d = 0; d < count; ++d) {
      std::memcpy(&poses_[d], request_.data() + geometry_head + pose_size * d, pose_size);
      const auto& turn = poses_[d].turn;
      const float norm = std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
      if (!(std::abs(norm - 1) < 1e-3f))
        return refuse(now_s, fmt::format("the rotation of device {} is not a unit quaternion", d), out);
    }
    configured_ = true;
    out.push_back(0);
    return true;
  }
  if (!configured_) return refuse(now_s, fmt::format("request 0x{:02x} before the geometry", kind), out);
  switch (kind) {
    case ask_send:
      for (std::size_t d = 0; d < devices_.size(); ++d) {
        devices_[d].receive(
            now_s, std::span(request_).subspan(1 + EmulatedDevice::message_size * d, EmulatedDevice::message_size));
      }
      out.push_back(0);
      return true;
    case ask_read:
      out.push_back(0);
      for (const EmulatedDevice& device : devices_) {
        const auto answer = device.answer();
        out.insert(out.end(), answer.begin(), answer.end());
      }
      return true;
    case ask_close:
      said_goodbye_ = true;
      out.push_back(0);
      return false;
    default:
      return refuse(now_s, fmt::format("unknown request 0x{:02x}", kind), out);
  }
}

bool EmulatedServer::silent(double now_s) const {
  return std::all_of(devices_.begin(), devices_.end(), [&](const EmulatedDevice& d) { return d.silent(now_s); });
}

std::vector<emulate::Violation> EmulatedServer::violations() const {
  std::vector<emulate::Violation> all = violations_.kept();
  for (const EmulatedDevice& device : devices_)
    all.insert(all.end(), device.violations().kept().begin(), device.violations().kept().end());
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return all;
}

std::size_t EmulatedServer::violation_count() const {
  std::size_t count = violations_.count();
  for (const EmulatedDevice& device : devices_)
    count += device.violations().count();
  return count;
}

}  // namespace palpa::driver::autd3
