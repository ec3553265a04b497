#include "driver/usb/local_server.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.hpp"

namespace palpa::driver::usb {
namespace {

constexpr unsigned most_emulators = 64;
constexpr std::size_t most_clients = 16;

/// Held while looking for a free address. An address at which nothing answers is removed, and it must not belong to a
/// server that has just come.
class AddressLock {
 public:
  explicit AddressLock(const std::filesystem::path& folder)
      : file_(open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (file_ < 0 || flock(file_, LOCK_EX) != 0) {
      throw failure(fmt::format("{}: cannot be locked for the emulators' sockets: {}", (folder / "lock").string(),
                                std::generic_category().message(errno)));
    }
  }
  ~AddressLock() { close(file_); }
  AddressLock(const AddressLock&) = delete;
  AddressLock& operator=(const AddressLock&) = delete;

 private:
  int file_;
};

/// Whether nothing listens there any more.
bool dead(const sockaddr* address, socklen_t size) {
  const int probe = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool refused = connect(probe, address, size) != 0 && errno == ECONNREFUSED;
  close(probe);
  return refused;
}

}  // namespace

LocalServer::LocalServer(Peripheral& peripheral, Wiretap* tap)
    : peripheral_(peripheral), tap_(tap), packet_(sizeof(LocalMessage) + most_local_bytes) {
  listen_at_free_address();
}

LocalServer::~LocalServer() {
  for (const Client& client : clients_)
    close(client.fd);
  if (listener_ >= 0) {
    close(listener_);
    unlink(address_.c_str());
  }
}

void LocalServer::listen_at_free_address() {
  const std::filesystem::path folder = runtime_folder();
  const AddressLock lock(folder);
  for (unsigned number = 1; number <= most_emulators; ++number) {
    address_ = folder / fmt::format("usb-{}.sock", number);
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    const std::string text = address_.string();
    if (text.size() >= sizeof name.sun_path) {
      throw failure(fmt::format("{}: too long for a socket's address: set XDG_RUNTIME_DIR to a shorter path", text));
    }
    std::memcpy(name.sun_path, text.c_str(), text.size() + 1);
    const auto* address = reinterpret_cast<const sockaddr*>(&name);
    listener_ = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const auto bound = [&] { return bind(listener_, address, sizeof name) == 0; };
    bool there = bound();
    if (!there && errno == EADDRINUSE) {
      if (dead(address, sizeof name) && unlink(text.c_str()) == 0) there = bound();
      if (!there) {
        close(std::exchange(listener_, -1));
        continue;
      }
    }
    if (there && listen(listener_, most_clients) == 0) return;
    const int code = errno;
    close(std::exchange(listener_, -1));
    throw failure(fmt::format("{}: cannot listen there: {}", text, std::generic_category().message(code)));
  }
  throw failure(fmt::format("{}: {} emulators listen there already", folder.string(), most_emulators));
}

void LocalServer::watch(std::vector<pollfd>& watched) const {
  watched.push_back({listener_, POLLIN, 0});
  for (const Client& client : clients_)
    watched.push_back({client.fd, POLLIN, 0});
}

bool LocalServer::waits() const {
  return std::any_of(clients_.begin(), clients_.end(), [](const Client& client) { return !client.transfers.empty(); });
}

void LocalServer::answer(const Client& client, const LocalMessage& message, std::span<const std::uint8_t> bytes) {
  // A client that does not read its answers loses them.
  static_cast<void>(send_message(client.fd, message, bytes));
}

void LocalServer::end_transfer(Client& client, Outcome outcome, double now_s) {
  const Transfer& transfer = client.transfers.front();
  if (tap_ != nullptr && transfer.taken > 0)
    tap_->bulk(now_s, client.endpoint, std::span(transfer.bytes).first(transfer.taken));
  LocalMessage message;
  message.kind = LocalMessage::bulk;
  message.number = transfer.number;
  message.outcome = outcome;
  message.bytes = static_cast<std::uint32_t>(transfer.taken);
  answer(client, message);
  client.transfers.pop_front();
}

void LocalServer::end_transfers(Client& client, Outcome outcome, double now_s) {
  while (!client.transfers.empty())
    end_transfer(client, outcome, now_s);
}

void LocalServer::carry(Client& client, double now_s) {
  while (!client.transfers.empty()) {
    Transfer& transfer = client.transfers.front();
    transfer.taken +=
        peripheral_.bulk_out(now_s, client.endpoint, std::span(std::as_const(transfer.bytes)).subspan(transfer.taken));
    if (transfer.taken < transfer.bytes.size()) return;
    end_transfer(client, Outcome::done, now_s);
  }
}

/// The client has closed its end. Data that it had not transferred when it died never comes.
void LocalServer::leave(Client& client, double now_s) {
  close(std::exchange(client.fd, -1));
  if (!std::exchange(client.owner, false)) return;
  client.transfers.clear();
  peripheral_.closed(now_s);
}

void LocalServer::describe(const Client& client, const LocalMessage& message) {
  const auto& identity = peripheral_.identity();
  LocalIdentity reply;
  reply.vendor = identity.vendor;
  reply.product = identity.product;
  reply.release = identity.release;
  identity.serial.copy(reply.serial.data(), reply.serial.size() - 1);
  answer(client, message, {reinterpret_cast<const std::uint8_t*>(&reply), sizeof reply});
}

void LocalServer::claim(Client& client, LocalMessage message) {
  const bool owned = std::any_of(clients_.begin(), clients_.end(), [](const Client& c) { return c.owner; });
  message.outcome = owned ? Outcome::stalled : Outcome::done;
  client.endpoint = static_cast<std::uint8_t>(message.number);
  client.owner = client.owner || !owned;
  answer(client, message);
}

void LocalServer::request(const Client& client, LocalMessage message, double now_s) {
  std::array<std::uint8_t, 256> in{};
  std::size_t filled = 0;
  message.outcome = peripheral_.control(now_s, message.setup,
                                        std::span(in).first(std::min<std::size_t>(message.bytes, in.size())), filled);
  if (tap_ != nullptr) tap_->control(now_s, message.setup, std::span(in).first(filled));
  answer(client, message, std::span(in).first(filled));
}

void LocalServer::take(Client& client, LocalMessage message, std::span<const std::uint8_t> bytes, double now_s) {
  switch (message.kind) {
    case LocalMessage::describe:
      return describe(client, message);
    case LocalMessage::claim:
      return claim(client, message);
    case LocalMessage::request:
      return request(client, message, now_s);
    case LocalMessage::bulk:
      client.transfers.push_back({message.number, 0, {bytes.begin(), bytes.end()}});
      return carry(client, now_s);
    case LocalMessage::cancel:
      return end_transfers(client, Outcome::cancelled, now_s);
    case LocalMessage::clear_halt:
      message.outcome = Outcome::done;
      return answer(client, message);
    default:
      return;
  }
}

/// Handles one packet. Returns false if there is no more. A client that is gone has no descriptor any more.
bool LocalServer::hear(Client& client, const std::function<double()>& now) {
  const ssize_t came = recv(client.fd, packet_.data(), packet_.size(), 0);
  const double now_s = now();
  if (came < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (came < static_cast<ssize_t>(sizeof(LocalMessage))) {
    leave(client, now_s);
    return false;
  }
  LocalMessage message;
  std::memcpy(&message, packet_.data(), sizeof message);
  if (message.kind != LocalMessage::describe && message.kind != LocalMessage::claim && !client.owner) {
    message.outcome = Outcome::failed;
    answer(client, message);
    return true;
  }
  take(client, message, {packet_.data() + sizeof message, static_cast<std::size_t>(came) - sizeof message}, now_s);
  return true;
}

void LocalServer::go_on(const std::function<double()>& now) {
  peripheral_.advance(now());
  for (int fd = 0; clients_.size() < most_clients;) {
    fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) break;
    clients_.push_back({fd, false, 0, {}});
  }
  for (Client& client : clients_) {
    carry(client, now());
    while (hear(client, now)) {
    }
  }
  std::erase_if(clients_, [](const Client& client) { return client.fd < 0; });
}

}  // namespace palpa::driver::usb
