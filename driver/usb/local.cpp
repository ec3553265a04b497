#include "driver/usb/local.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "driver/clock.hpp"

namespace palpa::driver::usb {
namespace {

/// Each emulator is on its own bus, beyond all real ones.
constexpr unsigned first_bus = 1000;

class Connection {
 public:
  explicit Connection(const std::filesystem::path& address)
      : fd_(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    const std::string text = address.string();
    if (fd_ < 0 || text.size() >= sizeof name.sun_path) return;
    std::memcpy(name.sun_path, text.c_str(), text.size() + 1);
    connected_ = connect(fd_, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
  }
  ~Connection() {
    if (fd_ >= 0) close(fd_);
  }
  Connection(Connection&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), connected_(std::exchange(other.connected_, false)) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  Connection& operator=(Connection&&) = delete;

  bool connected() const { return connected_; }

  enum class Result { done, later, gone };
  Result send(const LocalMessage& message, std::span<const std::uint8_t> bytes = {}) {
    const ssize_t sent = connected_ ? send_message(fd_, message, bytes) : -1;
    if (sent >= 0) return Result::done;
    if (connected_ && (errno == EAGAIN || errno == EINTR)) return Result::later;
    connected_ = false;
    return Result::gone;
  }
  /// `filled` gets the number of bytes that came behind the message.
  Result receive(LocalMessage& message, std::span<std::uint8_t> into, std::size_t& filled) {
    iovec parts[]{{&message, sizeof message}, {into.data(), into.size()}};
    msghdr packet{};
    packet.msg_iov = parts;
    packet.msg_iovlen = 2;
    const ssize_t came = connected_ ? recvmsg(fd_, &packet, 0) : 0;
    if (came >= static_cast<ssize_t>(sizeof message)) {
      filled = static_cast<std::size_t>(came) - sizeof message;
      return Result::done;
    }
    if (connected_ && came < 0 && (errno == EAGAIN || errno == EINTR)) return Result::later;
    connected_ = false;
    return Result::gone;
  }
  void wait(double seconds) {
    pollfd one = watched();
    poll(&one, 1, static_cast<int>(1000 * seconds));
  }
  pollfd watched() const { return {fd_, POLLIN, 0}; }

 private:
  int fd_;
  bool connected_ = false;
};

class LocalDevice final : public Device {
 public:
  explicit LocalDevice(Connection connection) : connection_(std::move(connection)) {}

  using Device::request;
  Outcome request(const Setup& setup, std::span<std::uint8_t> in, std::size_t& received) override {
    LocalMessage message;
    message.kind = LocalMessage::request;
    message.setup = setup;
    message.bytes = static_cast<std::uint32_t>(in.size());
    return ask(message, in, received);
  }
  Outcome clear_halt() override {
    LocalMessage message;
    message.kind = LocalMessage::clear_halt;
    std::size_t none = 0;
    return ask(message, {}, none);
  }
  /// Takes the endpoint, as opening does.
  Outcome claim(std::uint8_t endpoint) {
    LocalMessage message;
    message.kind = LocalMessage::claim;
    message.number = endpoint;
    std::size_t none = 0;
    return ask(message, {}, none);
  }

  Outcome submit(unsigned number, std::span<const std::uint8_t> bytes) override {
    if (!connection_.connected()) return Outcome::gone;
    if (bytes.size() > most_local_bytes) return Outcome::failed;
    pending_[number] = {bytes, next_++, State::waits, {}};
    push();
    return Outcome::done;
  }

  std::optional<Sent> reap() override {
    push();
    LocalMessage message;
    std::size_t none = 0;
    while (connection_.connected() && connection_.receive(message, {}, none) == Connection::Result::done)
      note(message);
    for (unsigned number = 0; number < pending_.size(); ++number) {
      Pending& pending = pending_[number];
      if (pending.state == State::none) continue;
      if (pending.state != State::ended) {
        if (connection_.connected()) continue;
        pending.sent = {number, Outcome::gone, 0};
      }
      pending.state = State::none;
      return pending.sent;
    }
    return std::nullopt;
  }

  pollfd watched() const override { return connection_.watched(); }

  void cancel() override {
    for (unsigned number = 0; number < pending_.size(); ++number) {
      if (pending_[number].state != State::waits) continue;
      pending_[number].state = State::ended;
      pending_[number].sent = {number, Outcome::cancelled, 0};
    }
    LocalMessage message;
    message.kind = LocalMessage::cancel;
    connection_.send(message);
  }

 private:
  enum class State { none, waits, flies, ended };
  struct Pending {
    std::span<const std::uint8_t> bytes;
    std::uint64_t order = 0;
    State state = State::none;
    Sent sent{};
  };

  /// Sends what waits, in order.
  void push() {
    for (;;) {
      Pending* next = nullptr;
      for (Pending& pending : pending_) {
        if (pending.state == State::waits && (next == nullptr || pending.order < next->order)) next = &pending;
      }
      if (next == nullptr) return;
      LocalMessage message;
      message.kind = LocalMessage::bulk;
      message.number = static_cast<std::uint32_t>(next - pending_.data());
      if (connection_.send(message, next->bytes) != Connection::Result::done) return;
      next->state = State::flies;
    }
  }

  void note(const LocalMessage& message) {
    if (message.kind != LocalMessage::bulk || message.number >= pending_.size()) return;
    Pending& pending = pending_[message.number];
    if (pending.state != State::flies) return;
    pending.state = State::ended;
    pending.sent = {message.number, message.outcome, message.bytes};
  }

  Outcome ask(const LocalMessage& message, std::span<std::uint8_t> in, std::size_t& received) {
    received = 0;
    if (connection_.send(message) != Connection::Result::done) return Outcome::gone;
    // Answers of transfers that end meanwhile come in between.
    for (int tries = 0; tries < 200; ++tries) {
      LocalMessage answer;
      switch (connection_.receive(answer, in, received)) {
        case Connection::Result::done:
          if (answer.kind == message.kind) return answer.outcome;
          note(answer);
          break;
        case Connection::Result::later:
          connection_.wait(request_patience_s / 50);
          if (tries >= 50) return Outcome::timed_out;
          break;
        case Connection::Result::gone:
          return Outcome::gone;
      }
    }
    return Outcome::timed_out;
  }

  Connection connection_;
  std::array<Pending, most_in_flight> pending_;
  std::uint64_t next_ = 0;
};

/// N of "usb-N.sock"; 0 for any other name.
unsigned number_of(const std::filesystem::path& address) {
  const std::string name = address.filename().string();
  unsigned number = 0;
  if (!name.starts_with("usb-") || !name.ends_with(".sock")) return 0;
  std::from_chars(name.data() + 4, name.data() + name.size() - 5, number);
  return number;
}

std::filesystem::path runtime_place() {
  const auto given = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
  };
  if (const std::filesystem::path own = given("XDG_RUNTIME_DIR"); !own.empty()) return own / "palpa";
  const std::filesystem::path temporary = given("TMPDIR");
  return (temporary.empty() ? "/tmp" : temporary) / fmt::format("palpa-{}", getuid());
}

std::filesystem::path address_of(unsigned number) {
  return runtime_folder() / fmt::format("usb-{}.sock", number);
}

}  // namespace

std::filesystem::path runtime_folder() {
  std::filesystem::path folder = runtime_place();
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    throw failure(fmt::format("{}: cannot be created for the emulators' sockets: {}", folder.string(),
                              std::generic_category().message(errno)));
  }
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) || status.st_uid != getuid() ||
      (status.st_mode & 0077) != 0) {
    throw failure(
        fmt::format("{}: must be a folder that you own, with mode 0700, for the emulators' sockets", folder.string()));
  }
  return folder;
}

bool is_emulated(const Entry& entry) {
  return entry.bus >= first_bus;
}

ssize_t send_message(int socket, const LocalMessage& message, std::span<const std::uint8_t> bytes) {
  iovec parts[]{{const_cast<LocalMessage*>(&message), sizeof message},
                {const_cast<std::uint8_t*>(bytes.data()), bytes.size()}};
  msghdr packet{};
  packet.msg_iov = parts;
  packet.msg_iovlen = 2;
  return sendmsg(socket, &packet, MSG_NOSIGNAL);
}

Listing LocalTransport::list(Wanted wanted) {
  Listing listing;
  std::error_code code;
  if (!std::filesystem::exists(runtime_place(), code)) return listing;  // nothing listens, and no folder is made
  std::filesystem::path folder;
  try {
    folder = runtime_folder();
  } catch (const Error& error) {
    listing.problem = error.what();
    return listing;
  }
  // An emulator that does not answer is left out. All of them together take no longer than one device may.
  double patience_s = request_patience_s;
  const SteadyClock clock;
  for (std::filesystem::directory_iterator file(folder, code), end; !code && file != end; file.increment(code)) {
    const unsigned number = number_of(file->path());
    if (number == 0) continue;
    Connection connection(file->path());
    LocalMessage message;
    if (!connection.connected() || connection.send(message) != Connection::Result::done) continue;
    LocalIdentity identity;
    std::size_t filled = 0;
    const double begin_s = clock.now_s();
    connection.wait(std::max(patience_s, 0.01));
    patience_s -= clock.now_s() - begin_s;
    const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(&identity), sizeof identity);
    if (connection.receive(message, bytes, filled) != Connection::Result::done || filled != sizeof identity) continue;
    Entry entry;
    entry.vendor = identity.vendor;
    entry.product = identity.product;
    entry.release = identity.release;
    entry.bus = first_bus + number;
    entry.address = 1;
    entry.place = fmt::format("emulated-{}", number);
    if (wanted(entry.vendor, entry.product)) {
      entry.serial.assign(identity.serial.data(), strnlen(identity.serial.data(), identity.serial.size()));
    }
    listing.entries.push_back(std::move(entry));
  }
  std::sort(listing.entries.begin(), listing.entries.end(), [](const auto& a, const auto& b) { return a.bus < b.bus; });
  return listing;
}

std::unique_ptr<Device> LocalTransport::open(const Entry& entry, std::uint8_t endpoint) {
  Connection connection(address_of(entry.bus - first_bus));
  if (!connection.connected()) {
    throw failure(fmt::format("emulated device {} at {} does not listen any more", entry.serial, entry.place));
  }
  auto device = std::make_unique<LocalDevice>(std::move(connection));
  if (const Outcome outcome = device->claim(endpoint); outcome != Outcome::done) {
    throw failure(fmt::format("emulated device {} at {} cannot be claimed: {}", entry.serial, entry.place,
                              outcome == Outcome::stalled ? "another program has it" : text_of(outcome)));
  }
  return device;
}

}  // namespace palpa::driver::usb
