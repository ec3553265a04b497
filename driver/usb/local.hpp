// Emulated devices of other processes: each listens on a socket in this user's runtime folder, and is listed and opened
// like real ones. `palpa emulate` is the other side (local_server.hpp).
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "driver/usb/device.hpp"

namespace palpa::driver::usb {

/// $XDG_RUNTIME_DIR/palpa, or without that variable palpa-UID in the folder for temporary files; made with mode 0700 if
/// it is not there. Throws failure() if it cannot be made or belongs to another user.
std::filesystem::path runtime_folder();

/// Whether the entry is one of LocalTransport's.
bool is_emulated(const Entry& entry);

class LocalTransport final : public Transport {
 public:
  Listing list(Wanted wanted) override;
  std::unique_ptr<Device> open(const Entry& entry, std::uint8_t endpoint) override;
};

/// What goes over the socket. Each packet is this, followed by the bytes that belong to it.
struct LocalMessage {
  enum Kind : std::uint32_t { describe, claim, request, bulk, cancel, clear_halt };
  std::uint32_t kind = describe;  ///< an answer has the kind of its question
  std::uint32_t number = 0;       ///< of a transfer; of a claim: the endpoint
  Outcome outcome = Outcome::done;
  std::uint32_t bytes = 0;  ///< that were sent, or are wanted
  Setup setup{};
};
/// One packet; returns what sendmsg() does.
ssize_t send_message(int socket, const LocalMessage& message, std::span<const std::uint8_t> bytes);

inline constexpr std::size_t most_local_bytes = 16384;  ///< of one transfer
/// The answer to `describe`: ids and the serial number, ended by a zero.
struct LocalIdentity {
  std::uint16_t vendor = 0, product = 0, release = 0;
  std::array<char, 64> serial{};
};

}  // namespace palpa::driver::usb
