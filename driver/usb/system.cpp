#include "driver/usb/system.hpp"

#include <utility>

#include "driver/usb/libusb.hpp"
#include "driver/usb/local.hpp"

namespace palpa::driver::usb {
namespace {

class WithEmulators final : public Transport {
 public:
  WithEmulators(std::unique_ptr<Transport> real, std::unique_ptr<Transport> emulated)
      : real_(std::move(real)), emulated_(std::move(emulated)) {}

  Listing list(Wanted wanted) override {
    Listing listing = real_->list(wanted);
    const Listing emulated = emulated_->list(wanted);
    listing.entries.insert(listing.entries.end(), emulated.entries.begin(), emulated.entries.end());
    if (!emulated.entries.empty()) listing.problem.clear();
    if (!emulated.problem.empty()) listing.problem += (listing.problem.empty() ? "" : "; ") + emulated.problem;
    return listing;
  }
  std::unique_ptr<Device> open(const Entry& entry, std::uint8_t endpoint) override {
    return (is_emulated(entry) ? emulated_ : real_)->open(entry, endpoint);
  }

 private:
  std::unique_ptr<Transport> real_, emulated_;
};

}  // namespace

std::unique_ptr<Transport> with_emulators(std::unique_ptr<Transport> real, std::unique_ptr<Transport> emulated) {
  return std::make_unique<WithEmulators>(std::move(real), std::move(emulated));
}

std::unique_ptr<Transport> system_transport() {
  return with_emulators(std::make_unique<LibusbTransport>(), std::make_unique<LocalTransport>());
}

}  // namespace palpa::driver::usb
