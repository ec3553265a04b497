#include "usb/vhci_port.hpp"

#include <endian.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "support/begins.hpp"

namespace palpa::test {
namespace {

const std::filesystem::path controller = "/sys/devices/platform/vhci_hcd.0";
constexpr int high_speed = 3;

enum Command : std::uint32_t { cmd_submit = 1, cmd_unlink = 2, ret_submit = 3, ret_unlink = 4 };

/// The state of a high-speed port; 4: free, 6: a device is there.
int state_of(unsigned port) {
  std::ifstream status(controller / "status");
  std::string line;
  while (std::getline(status, line)) {
    std::istringstream words(line);
    std::string hub;
    unsigned number = 0;
    int state = 0;
    if (words >> hub >> number >> state && hub == "hs" && number == port) return state;
  }
  return 0;
}

unsigned free_port() {
  for (unsigned port = 0; port < 8; ++port) {
    if (state_of(port) == 4) return port;
  }
  throw std::runtime_error("no free port of vhci_hcd: is its module loaded? (./dev test usb does that, in a guest)");
}

std::string first_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

bool send_all(int fd, const void* bytes, std::size_t count) {
  const auto* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t sent = send(fd, at, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    count -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int fd, void* bytes, std::size_t count) {
  return count == 0 || recv(fd, bytes, count, MSG_WAITALL) == static_cast<ssize_t>(count);
}

}  // namespace

/// USB/IP's header, each number with its highest byte first. The contents of `fields` depend on the command.
struct VhciPort::Message {
  std::uint32_t command = 0, number = 0, device = 0, to_host = 0, endpoint = 0;
  /// Submit: flags, length, start frame, packets, interval. Its answer: status, length, start frame, packets, errors.
  /// Unlink: the number of the transfer. Its answer: status.
  std::array<std::uint32_t, 5> fields{};
  std::array<std::uint8_t, 8> setup{};

  std::uint32_t field(std::size_t i) const { return be32toh(fields[i]); }
};

bool eventually(double seconds, const std::function<bool()>& condition) {
  for (int i = 0; i < 200 * seconds; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

void VhciPort::plug() {
  static_assert(sizeof(Message) == 48);
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) throw std::runtime_error("no socket pair");
  port_ = free_port();
  fd_ = ends[1];
  ends_ = false;
  plugged_ = true;
  thread_ = std::thread([this] { serve(); });
  const unsigned id = 1u << 16 | (port_ + 1);
  std::ofstream attach(controller / "attach");
  attach << port_ << ' ' << ends[0] << ' ' << id << ' ' << high_speed << std::endl;
  const bool attached = attach.good();
  close(ends[0]);  // the kernel has it
  const std::filesystem::path devices = "/sys/bus/usb/devices";
  // Its first root hub is the one of high-speed ports.
  place_.clear();
  for (const auto& entry : std::filesystem::directory_iterator(controller)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("usb") && first_line(entry.path() / "speed") == "480") {
      place_ = name.substr(3) + "-" + std::to_string(port_ + 1);
    }
  }
  const bool known =
      attached && begins([&] {
        return !first_line(devices / place_ / "bConfigurationValue").empty() && std::filesystem::exists(device_file());
      });
  if (known) return;
  unplug();
  throw std::runtime_error("the kernel does not take the device at " + place_);
}

std::string VhciPort::device_file() const {
  const std::filesystem::path device = std::filesystem::path("/sys/bus/usb/devices") / place_;
  const auto padded = [](std::string number) {
    return std::string(3 - std::min<std::size_t>(3, number.size()), '0') + number;
  };
  return "/dev/bus/usb/" + padded(first_line(device / "busnum")) + "/" + padded(first_line(device / "devnum"));
}

void VhciPort::unplug() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  // The port is free before the device has disappeared.
  const std::filesystem::path device = std::filesystem::path("/sys/bus/usb/devices") / place_;
  static_cast<void>(
      begins([&] { return state_of(port_) == 4 && (place_.empty() || !std::filesystem::exists(device)); }));
}

/// The thread, from plug to unplug.
void VhciPort::serve() {
  while (!ends_ && plugged_) {
    pollfd watched{fd_, POLLIN, 0};
    bool waits = false;
    for (const auto& [endpoint, transfers] : waiting_)
      waits = waits || !transfers.empty();
    const timespec patience{0, waits ? 1'000'000 : 5'000'000};
    const bool heard = ppoll(&watched, 1, &patience, nullptr) > 0;
    const std::lock_guard lock(mutex_);
    gadget_.advance(now_s());
    if (heard) hear();
    if (plugged_) carry();
  }
  const std::lock_guard lock(mutex_);
  drop();
}

void VhciPort::drop() {
  plugged_ = false;
  if (fd_ < 0) return;
  close(std::exchange(fd_, -1));
  waiting_.clear();
  gadget_.unplugged(now_s());
}

void VhciPort::hear() {
  Message message;
  if (!receive_all(fd_, &message, sizeof message)) return drop();
  if (be32toh(message.command) == cmd_submit) return submit(message);
  if (be32toh(message.command) == cmd_unlink) return unlink(message);
  drop();
}

void VhciPort::submit(const Message& message) {
  UsbTransfer transfer;
  const bool to_host = be32toh(message.to_host) == 1;
  transfer.number = be32toh(message.number);
  transfer.endpoint = static_cast<std::uint8_t>(be32toh(message.endpoint) | (to_host ? 0x80 : 0));
  transfer.bytes.resize(message.field(1));
  if (!to_host && !receive_all(fd_, transfer.bytes.data(), transfer.bytes.size())) return drop();
  if ((transfer.endpoint & 0x7f) != 0) {
    waiting_[transfer.endpoint].push_back(std::move(transfer));
    return;
  }
  const auto& setup = message.setup;
  const auto word = [&](std::size_t i) { return static_cast<std::uint16_t>(setup[i] | setup[i + 1] << 8); };
  const ControlRequest request{setup[0], setup[1], word(2), word(4), word(6)};
  const bool standard = (request.type & 0x60) == 0;
  const Answer became =
      standard ? standard_request(gadget_, request, transfer.bytes) : gadget_.control(now_s(), request, transfer.bytes);
  transfer.done = transfer.bytes.size();
  if (became == Answer::unplugged) return drop();
  answer(transfer, became == Answer::done);
}

/// A transfer that was answered in the meantime is no longer in the list, and is never answered after its unlink.
void VhciPort::unlink(const Message& message) {
  const std::uint32_t number = message.field(0);
  bool found = false;
  for (auto& [endpoint, transfers] : waiting_) {
    found =
        std::erase_if(transfers, [&](const UsbTransfer& transfer) { return transfer.number == number; }) > 0 || found;
  }
  Message reply;
  reply.command = htobe32(ret_unlink);
  reply.number = message.number;
  reply.fields[0] = htobe32(found ? static_cast<std::uint32_t>(-ECONNRESET) : 0);
  if (!send_all(fd_, &reply, sizeof reply)) drop();
}

void VhciPort::carry() {
  for (auto& [endpoint, transfers] : waiting_) {
    while (!transfers.empty()) {
      const Answer became = gadget_.carry(now_s(), transfers.front());
      if (became == Answer::later) break;
      if (became == Answer::unplugged) return drop();
      UsbTransfer transfer = std::move(transfers.front());
      transfers.pop_front();
      answer(transfer, became == Answer::done);
      if (!plugged_) return;
    }
  }
}

void VhciPort::answer(UsbTransfer& transfer, bool ok) {
  const bool to_host = (transfer.endpoint & 0x80) != 0;
  Message reply;
  reply.command = htobe32(ret_submit);
  reply.number = htobe32(transfer.number);
  reply.fields[0] = htobe32(ok ? 0 : static_cast<std::uint32_t>(-EPIPE));
  reply.fields[1] = htobe32(static_cast<std::uint32_t>(transfer.done));
  const bool sent =
      send_all(fd_, &reply, sizeof reply) && (!to_host || send_all(fd_, transfer.bytes.data(), transfer.done));
  if (!sent) drop();
}

}  // namespace palpa::test
