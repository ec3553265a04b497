#include "driver/doctor.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "driver/usb/ftdi.hpp"
#include "driver/usb/libusb.hpp"
#include "driver/usb/local.hpp"
#include "driver/v4l2/doctor.hpp"
#include "driver/v4l2/kernel.hpp"
#include "driver/v4l2/rig.hpp"

namespace palpa::driver {
namespace {

constexpr int any_product = -1;

struct Known {
  std::uint16_t vendor;
  int product;
  const char* chip;
  const char* remark;  ///< what uses the chip
};

/// The USB chips of the open 40 kHz arrays. Each is also found in other devices, so a board is never opened by its id
/// alone.
constexpr Known boards[]{
    {0x0403, 0x6014, "FT232H", "OpenMPD board; also JTAG probes and others: tell them apart by the serial number"},
    {0x0403, 0x6010, "FT2232H",
     "two-channel FTDI array; also JTAG probes and others: tell them apart by the serial number"},
    {0x0403, 0x6001, "FT232R", "SonicSurface on an FTDI serial adapter"},
    {0x1a86, 0x7523, "CH340", "SonicSurface or an Arduino clone on a CH340 serial adapter"},
    {0x10c4, 0xea60, "CP210x", "SonicSurface on a CP210x serial adapter"},
    {0x2341, any_product, "Arduino", "Ultraino and SonicSurface on an Arduino"},
};

constexpr Known cameras[]{
    {0x8086, 0x0ad3, "RealSense D415", ""},  {0x8086, 0x0b07, "RealSense D435", ""},
    {0x8086, 0x0b3a, "RealSense D435i", ""}, {0x8086, 0x0b5b, "RealSense D405", ""},
    {0x8086, 0x0b5c, "RealSense D455", ""},  {0x8086, 0x0b48, "RealSense SR305", ""},
};

template <std::size_t N>
const Known* find(const Known (&table)[N], std::uint16_t vendor, std::uint16_t product) {
  for (const Known& known : table) {
    if (known.vendor == vendor && (known.product == any_product || known.product == product)) return &known;
  }
  return nullptr;
}

/// Whether udev reads that file, according to udev(7). udev looks only in these folders, whatever palpa's prefix is.
constexpr bool udev_reads(std::string_view rules) {
  for (const std::string_view folder : {"/etc", "/run", "/usr/local/lib", "/usr/lib", "/lib"}) {
    if (rules.starts_with(folder) && rules.substr(folder.size()).starts_with("/udev/rules.d/")) return true;
  }
  return false;
}
static_assert(udev_reads("/usr/local/lib/udev/rules.d/70-palpa.rules"));
static_assert(!udev_reads("/opt/palpa/lib/udev/rules.d/70-palpa.rules"));

/// What to do about missing permission.
std::string no_permission() {
  // Installed programs find them from their own place, wherever that is.
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::string rules = program.parent_path().parent_path() / PALPA_UDEV_RULES_DIR "/70-palpa.rules";
  const bool there = std::filesystem::exists(rules, ignored);
  const std::string copy =
      there && udev_reads(rules)
          ? std::string()
          : fmt::format("copy {} to /etc/udev/rules.d, ", there ? rules : "driver/70-palpa.rules of palpa's sources");
  return fmt::format(
      "no permission: as root, {}run udevadm control --reload, then plug the device in again; if you work over ssh, "
      "join the group plugdev",
      copy);
}

/// The kernel driver that has a device's first interface; empty: none.
std::string kernel_driver(const std::string& place) {
  if (place.empty()) return {};
  std::error_code ignored;
  return std::filesystem::read_symlink(std::filesystem::path("/sys/bus/usb/devices") / (place + ":1.0") / "driver",
                                       ignored)
      .filename()
      .string();
}

cli::DoctorItem describe(const usb::Entry& device, const Known& known) {
  const std::string id = fmt::format("{:04x}:{:04x}", device.vendor, device.product);
  cli::DoctorItem item;
  item.title = fmt::format("{} {} at bus {} address {}", id, known.chip, device.bus, device.address);
  item.ok = device.refusal.empty();
  item.facts = {{"id", id},
                {"chip", std::string(known.chip)},
                {"bus", std::int64_t{device.bus}},
                {"address", std::int64_t{device.address}},
                {"place", device.place},
                {"serial", device.serial},
                {"usable", item.ok}};
  item.advice = known.remark;
  if (device.forbidden) {
    item.advice = no_permission();
  } else if (!device.refusal.empty()) {
    item.advice = fmt::format("cannot be opened: {}", device.refusal);
  } else if (const std::string driver = kernel_driver(device.place); !driver.empty()) {
    item.facts.push_back({"kernel_driver", driver});
    if (device.product == usb::ftdi::product_232h && driver == "ftdi_sio")
      item.advice += "; the kernel uses it as a serial port, which palpa removes while it has the device open";
  }
  return item;
}

/// Devices that palpa opens itself, or that the kernel opens for it. For the latter, palpa needs no permission of its
/// own.
enum class Opened { by_palpa, by_kernel };

template <std::size_t N>
void add_usb(cli::DoctorSection& section, const Known (&table)[N], usb::Wanted wanted, Opened opened) {
  const usb::Listing listing = usb::LibusbTransport().list(wanted);
  for (usb::Entry device : listing.entries) {
    if (opened == Opened::by_kernel) {
      device.refusal.clear();
      device.forbidden = false;
    }
    if (const Known* known = find(table, device.vendor, device.product))
      section.items.push_back(describe(device, *known));
  }
  section.note = listing.problem;
}

/// Adds the emulated boards that listen now (palpa emulate).
void add_emulators(cli::DoctorSection& section) {
  const usb::Listing listing = usb::LocalTransport().list([](std::uint16_t, std::uint16_t) { return true; });
  if (!listing.problem.empty()) section.note += (section.note.empty() ? "" : "; ") + listing.problem;
  for (const usb::Entry& device : listing.entries) {
    cli::DoctorItem item;
    item.title = fmt::format("{:04x}:{:04x} emulated, serial number {}", device.vendor, device.product, device.serial);
    item.ok = true;
    item.facts = {{"id", fmt::format("{:04x}:{:04x}", device.vendor, device.product)},
                  {"chip", std::string("emulated")},
                  {"place", device.place},
                  {"serial", device.serial},
                  {"usable", true}};
    section.items.push_back(std::move(item));
  }
}

cli::DoctorSection look_at_boards() {
  cli::DoctorSection section{"boards", "Boards", {}, {}};
  add_usb(
      section, boards, [](std::uint16_t v, std::uint16_t p) { return find(boards, v, p) != nullptr; },
      Opened::by_palpa);
  add_emulators(section);
  if (section.items.empty() && section.note.empty()) section.note = "no board on USB";
  return section;
}

cli::DoctorSection look_at_cameras() {
  cli::DoctorSection section{"cameras", "Depth cameras", {}, {}};
  add_usb(
      section, cameras, [](std::uint16_t v, std::uint16_t p) { return find(cameras, v, p) != nullptr; },
      Opened::by_kernel);
  const std::unique_ptr<v4l2::Kernel> kernel = v4l2::make_kernel();
  for (cli::DoctorItem& item : v4l2::describe_nodes(*kernel))
    section.items.push_back(std::move(item));
  if (section.items.empty()) {
    section.note =
        section.note.empty() ? "no depth camera on USB and no /dev/video*" : section.note + "; no /dev/video*";
  }
  return section;
}

}  // namespace

cli::CamerasThere cameras_there() {
  return v4l2::cameras_there(*v4l2::make_kernel());
}

std::vector<cli::DoctorProbe> doctor_probes() {
  return {look_at_boards, look_at_cameras};
}

}  // namespace palpa::driver
