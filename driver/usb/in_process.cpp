#include "driver/usb/in_process.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/error.hpp"

namespace palpa::driver::usb {

/// Transfers wait in a ring, in the order in which they were begun.
class InProcessDevice final : public Device {
 public:
  InProcessDevice(InProcessBus::Socket& socket, Clock& clock, std::uint8_t endpoint)
      : socket_(socket), clock_(clock), endpoint_(endpoint) {}
  ~InProcessDevice() override {
    if (!gone()) socket_.peripheral->closed(clock_.now_s());
  }

  using Device::request;
  Outcome request(const Setup& setup, std::span<std::uint8_t> in, std::size_t& received) override {
    received = 0;
    if (gone()) return Outcome::gone;
    clock_.sleep_s(socket_.faults.refuses_requests ? request_patience_s : socket_.faults.request_s);
    if (socket_.faults.refuses_requests) return Outcome::timed_out;
    return socket_.peripheral->control(clock_.now_s(), setup, in, received);
  }

  Outcome submit(unsigned number, std::span<const std::uint8_t> bytes) override {
    if (gone()) return Outcome::gone;
    pending_[(first_ + flying_) % most_in_flight] = {number, bytes, 0, false, Outcome::done};
    ++flying_;
    carry();
    return Outcome::done;
  }

  std::optional<Sent> reap() override {
    carry();
    if (flying_ == 0 || !pending_[first_].ended) return std::nullopt;
    const Pending& last = pending_[(first_ + flying_ - 1) % most_in_flight];
    if (socket_.faults.reaped_backwards && last.ended) {
      --flying_;
      return Sent{last.number, last.outcome, last.sent};
    }
    const Pending& pending = pending_[first_];
    first_ = (first_ + 1) % most_in_flight;
    --flying_;
    return Sent{pending.number, pending.outcome, pending.sent};
  }

  void cancel() override { end_all(gone() ? Outcome::gone : Outcome::cancelled); }

  Outcome clear_halt() override {
    if (gone()) return Outcome::gone;
    socket_.faults.stalled = false;
    return Outcome::done;
  }

 private:
  struct Pending {
    unsigned number = 0;
    std::span<const std::uint8_t> bytes;
    std::size_t sent = 0;
    bool ended = false;
    Outcome outcome = Outcome::done;
  };

  /// A device that was unplugged stays gone for the object that had it open, even when it is plugged in again.
  bool gone() {
    if (!gone_ && socket_.faults.unplugged) {
      gone_ = true;
      socket_.peripheral->unplugged(clock_.now_s());
    }
    return gone_;
  }

  void end_all(Outcome outcome) {
    for (std::size_t i = 0; i < flying_; ++i) {
      Pending& pending = pending_[(first_ + i) % most_in_flight];
      if (pending.ended) continue;
      pending.ended = true;
      pending.outcome = outcome;
    }
  }

  /// Passes to the device what it takes.
  void carry() {
    Faults& faults = socket_.faults;
    if (!gone()) socket_.peripheral->advance(clock_.now_s());
    for (std::size_t i = 0; i < flying_; ++i) {
      if (gone()) return end_all(Outcome::gone);
      if (faults.stalled) return end_all(Outcome::stalled);
      Pending& pending = pending_[(first_ + i) % most_in_flight];
      if (pending.ended) continue;
      if (faults.takes_nothing) return;
      std::span<const std::uint8_t> rest = pending.bytes.subspan(pending.sent);
      const bool cut = faults.cut_at != 0 && pending.sent + rest.size() > faults.cut_at;
      if (cut) rest = rest.first(faults.cut_at - std::min(pending.sent, faults.cut_at));
      if (rest.size() > faults.unplug_after) rest = rest.first(faults.unplug_after);
      const std::size_t taken = socket_.peripheral->bulk_out(clock_.now_s(), endpoint_, rest);
      pending.sent += taken;
      faults.bulk_bytes += taken;
      if (faults.unplug_after != static_cast<std::size_t>(-1)) {
        faults.unplug_after -= taken;
        if (faults.unplug_after == 0) faults.unplugged = true;
        continue;
      }
      if (taken < rest.size()) return;
      pending.ended = true;
      if (cut && faults.cuts_once) faults.cut_at = 0;
    }
  }

  InProcessBus::Socket& socket_;
  Clock& clock_;
  std::uint8_t endpoint_;
  bool gone_ = false;
  std::array<Pending, most_in_flight> pending_;
  std::size_t first_ = 0, flying_ = 0;
};

Faults& InProcessBus::plug(Peripheral& peripheral, unsigned bus) {
  const auto& identity = peripheral.identity();
  Entry entry;
  entry.vendor = identity.vendor;
  entry.product = identity.product;
  entry.release = identity.release;
  entry.serial = identity.serial;
  entry.bus = bus;
  entry.address = static_cast<unsigned>(sockets_.size()) + 1;
  entry.place = fmt::format("{}-{}", bus, entry.address);
  sockets_.push_back({&peripheral, entry, {}});
  return sockets_.back().faults;
}

Listing InProcessBus::list(Wanted wanted) {
  Listing listing;
  for (const Socket& socket : sockets_) {
    if (socket.faults.unplugged) continue;
    listing.entries.push_back(socket.entry);
    if (!wanted(socket.entry.vendor, socket.entry.product)) listing.entries.back().serial.clear();
  }
  return listing;
}

std::unique_ptr<Device> InProcessBus::open(const Entry& entry, std::uint8_t endpoint) {
  for (Socket& socket : sockets_) {
    if (socket.entry.place == entry.place && !socket.faults.unplugged)
      return std::make_unique<InProcessDevice>(socket, clock_, endpoint);
  }
  throw failure(fmt::format("USB device {} at {} is not plugged in any more", entry.serial, entry.place));
}

}  // namespace palpa::driver::usb
