#include "cli/doctor.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/system/real_time.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "cli/commands.hpp"
#include "cli/doctor_rig.hpp"
#include "geometry/parts/vhacd.hpp"
#include "gpu/device.hpp"
#include "gpu/software.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "session/control/osc_message.hpp"
#include "session/links/real_time_service.hpp"
#include "setup/options/study_options.hpp"

namespace palpa::cli {
namespace {

/// Throws bad_usage, naming --serial, for a serial number that is empty, longer than 16 characters, or has anything but
/// letters, digits, - and _, which the names of links need.
void check_serial(const std::string& serial) {
  constexpr std::size_t most = 16;
  constexpr std::string_view allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  if (serial.empty() || serial.size() > most || serial.find_first_not_of(allowed) != std::string::npos) {
    throw bad_usage(
        fmt::format("--serial {}: give 1 to {} letters, digits, - and _, such as LAB1", printable(serial, 60), most));
  }
}

/// `palpa doctor --write-eeprom`: the configuration with which the program ftdi_eeprom sets up the FT232H of an OpenMPD
/// board. palpa itself never writes to a device's EEPROM. `file`: the name under which it will be written.
std::string eeprom_configuration(const std::string& serial, const std::string& file) {
  return fmt::format(
      "# By palpa doctor: for the program ftdi_eeprom, which writes the EEPROM of an OpenMPD board's FT232H.\n"
      "# Plug in only this board, take away other devices with an FT232H, and run\n"
      "#   sudo ftdi_eeprom --read-eeprom {1}      # keeps the old contents in old-{0}.bin\n"
      "#   mv old-{0}.bin saved-{0}.bin            # because the next command writes that file, too\n"
      "#   sudo ftdi_eeprom --flash-eeprom {1}\n"
      "# Then unplug the board and plug it in again. palpa doctor lists it with its new serial number.\n"
      "filename=old-{0}.bin\n"
      "vendor_id=0x0403\n"
      "product_id=0x6014\n"
      "manufacturer=\"FTDI\"\n"
      "product=\"OpenMPD\"\n"
      "serial=\"{0}\"\n"
      "use_serial=true\n"
      "max_power=90\n"
      "self_powered=false\n"
      "remote_wakeup=false\n"
      "cha_type=FIFO      # 245 FIFO, which the board's firmware reads\n"
      "cha_vcp=false      # no serial port\n",
      serial, file);
}

struct DoctorOptions {
  setup::CommonOptions common;
  std::string write_rig, source;
  setup::RigOptions rig;
  std::string write_eeprom, serial;
};

void add_options_of_doctor(CLI::App& app, DoctorOptions& o) {
  const line::Group group(app, "Cameras");
  group.text(
      "--write-rig", o.write_rig, "FILE",
      "writes a rig with the depth cameras that are plugged in, at the places and with the array of --rig, if it "
      "is given; palpa calibrate then finds their poses");
  group.text("--source", o.source, "SOURCE",
             "with --write-rig: takes the cameras of recording:DIR or bag:FILE [those plugged in]");
  line::need(app, {"--source"}, "--write-rig");
  const line::Group placement(app, "Where cameras stand");
  placement.text("--rig", o.rig.rig, "FILE",
                 "says what the cameras of this rig will see, by simulation: a fingertip's contacts, the calibration "
                 "target on its mount, the array's boards");
  setup::add_layout(placement, o.rig.layout, "the array", " [the rig's]");
  line::need(app, {"--layout"}, "--rig");
  const line::Group boards(app, "Boards");
  boards.text("--write-eeprom", o.write_eeprom, "FILE",
              "writes the configuration with which the program ftdi_eeprom sets up the FT232H of an OpenMPD board; "
              "palpa itself writes to no device");
  boards.text("--serial", o.serial, "NAME", "with --write-eeprom: the board's new serial number", check_serial);
  line::need(app, {"--serial"}, "--write-eeprom");
  line::need(app, {"--write-eeprom"}, "--serial");
}

std::string driver_advice() {
  return gpu::driver_advice("install a Vulkan driver: apt-get install mesa-vulkan-drivers (it includes a CPU one)");
}

DoctorSection look_at_gpus() {
  DoctorSection section{"gpus", "GPUs", {}, {}};
  for (const gpu::DeviceDescription& device : gpu::list_devices()) {
    DoctorItem item;
    item.title = fmt::format("{} {}", device.index, device.name);
    item.advice = device.unusable.empty() ? gpu::lacking_room(device) : device.unusable;
    item.ok = item.advice.empty();
    item.facts = {{"index", std::int64_t{device.index}},
                  {"name", device.name},
                  {"driver", device.driver},
                  {"kind", device.kind},
                  {"usable", item.ok}};
    section.items.push_back(std::move(item));
  }
  if (section.items.empty()) section.note = fmt::format("none found: {}", driver_advice());
  return section;
}

DoctorSection look_at_validation() {
  DoctorItem layer;
  layer.title = "VK_LAYER_KHRONOS_validation";
  layer.ok = gpu::validation_layer_present();
  layer.facts = {{"present", layer.ok}};
  if (!layer.ok) layer.advice = "only --validation needs it: apt-get install vulkan-validationlayers";
  return {"validation", "Validation layer", {std::move(layer)}, {}};
}

/// What a build may leave out, as far as a command or a study needs it.
DoctorSection look_at_features() {
  const std::pair<const char*, std::string> optional[]{
      {"V-HACD", geometry::how_to_get_vhacd()},
      {"liblo", fmt::format("only messages to a live run (--osc) need it: {}", session::how_to_get_liblo)},
      {"D-Bus",
       "only real-time scheduling through rtkit needs it: install libdbus-1-dev (./dev deps build) and build palpa "
       "again"},
      {"SDL2", fmt::format("only the noise in the headphones of a study needs it: {}", setup::how_to_get_sdl2)}};
  DoctorSection section{"features", "Optional libraries of this build", {}, {}};
  for (const auto& [name, advice] : optional) {
    const bool has = built_with(name);
    section.items.push_back({name, has, has ? "" : advice, {{"name", name}, {"present", has}}});
  }
  return section;
}

/// Tries it in this thread. Afterwards, the process is as before.
DoctorSection look_at_scheduling() {
  const RealTime turns(output_priority, session::real_time_service());
  const Scheduling scheduling = scheduling_of(0);
  DoctorItem item;
  item.title = fmt::format("drives leave by {} scheduling", to_text(scheduling));
  item.ok = scheduling == Scheduling::real_time;
  if (!item.ok) item.advice = fmt::format("for fewer late ones: {}", session::how_to_get_real_time());
  item.facts = {{"scheduling", std::string(to_text(scheduling))}, {"kept_in_memory", KeptInMemory().holds()}};
  return {"scheduling", "Scheduling", {std::move(item)}, {}};
}

bool usable_gpu(const DoctorSection& gpus) {
  for (const DoctorItem& item : gpus.items) {
    if (item.ok) return true;
  }
  return false;
}

void append_text(std::string& out, const DoctorSection& section) {
  out += section.heading;
  out += '\n';
  for (const DoctorItem& item : section.items) {
    out += fmt::format("  {} {}", item.ok ? "ok" : "--", item.title);
    const char* before = " (";
    for (const auto& [name, fact] : item.facts) {
      // Index, name and verdict are already in the title.
      const auto* text = std::get_if<std::string>(&fact);
      if (!text || text->empty() || item.title.find(*text) != std::string::npos) continue;
      out += fmt::format("{}{} {}", before, name, *text);
      before = ", ";
    }
    if (before[0] == ',') out += ')';
    out += '\n';
    if (!item.advice.empty()) out += fmt::format("     {}\n", item.advice);
  }
  if (!section.note.empty()) out += fmt::format("  {}\n", section.note);
}

void append_json(JsonWriter& json, const DoctorSection& section) {
  json.key(section.key).begin_array(JsonWriter::Style::block);
  for (const DoctorItem& item : section.items) {
    json.begin_object(JsonWriter::Style::line);
    for (const auto& [name, fact] : item.facts) {
      json.key(name);
      std::visit([&](const auto& v) { json.value(v); }, fact);
    }
    if (!item.advice.empty()) json.member("advice", item.advice);
    json.end_object();
  }
  json.end_array();
}

std::string doctor_json(const std::vector<DoctorSection>& sections, bool ok, const setup::UsedBackend& computes) {
  JsonWriter json;
  json.begin_object().member("ok", ok);
  json.member("backend", word_of(setup::backend_words, computes.backend)).member("backend_why", computes.why);
  for (const DoctorSection& section : sections)
    append_json(json, section);
  json.key("notes").begin_object();
  for (const DoctorSection& section : sections) {
    if (!section.note.empty()) json.member(section.key, section.note);
  }
  json.end_object().end_object();
  return json.take();
}

/// Returns a message about the written file.
std::string write_found_rig(const DoctorOptions& options, const Extensions& extensions) {
  const CamerasThere there = cameras_there(extensions, options.source);
  write_file(options.write_rig, rig_of(there, options.write_rig, options.rig.rig));
  return fmt::format("{}: {} of --source {}; palpa calibrate finds out where {}\n", options.write_rig,
                     counted(there.cameras.size(), "camera"), there.source,
                     there.cameras.size() == 1 ? "it is" : "they are");
}

std::string conclusion(bool ok, const setup::UsedBackend& computes) {
  if (computes.backend == setup::Backend::cpu) {
    return fmt::format("palpa can run here{}. It computes on the processor, because {}.\n",
                       ok ? "" : ", except palpa-viewer and palpa bench", computes.why);
  }
  return ok ? fmt::format("palpa can run here. It computes with Vulkan, because {}.\n", computes.why)
            : fmt::format("palpa cannot compute here: it needs a Vulkan device, because {}.\n", computes.why);
}

void run_doctor(const DoctorOptions& options, const Extensions& extensions) {
  const Outputs outputs(
      {{"--json", options.common.json}, {"--write-rig", options.write_rig}, {"--write-eeprom", options.write_eeprom}});
  std::string written = options.write_rig.empty() ? std::string() : write_found_rig(options, extensions);
  if (!options.write_eeprom.empty()) {
    write_file(options.write_eeprom, eeprom_configuration(options.serial, options.write_eeprom));
    written +=
        fmt::format("{}: for ftdi_eeprom; its first lines say how to use it (docs/boards.md)\n", options.write_eeprom);
  }
  std::vector<DoctorSection> sections{look_at_gpus(), look_at_validation(), look_at_features(), look_at_scheduling()};
  for (const DoctorProbe& probe : extensions.doctor)
    sections.push_back(probe());
  if (!options.rig.rig.empty()) sections.push_back(look_at_rig(options.rig));
  const bool ok = usable_gpu(sections.front());
  const setup::UsedBackend computes = setup::used_backend(options.common);

  if (!options.common.json.empty()) write_file(options.common.json, doctor_json(sections, ok, computes));
  if (setup::shows_summary(options.common, outputs)) {
    std::string text;
    for (const DoctorSection& section : sections)
      append_text(text, section);
    text += written;
    text += conclusion(ok, computes);
    write_file("-", text);
  }
  if (!ok) throw Error(Exit::no_device, fmt::format("no usable Vulkan device: {}", driver_advice()));
}

}  // namespace

void add_doctor(Program& program) {
  add_subcommand<DoctorOptions>(
      program,
      {"doctor", "what works on this machine, and what to do about the rest",
       "  palpa doctor\n"
       "  palpa doctor --rig assets/rigs/openmpd-one.toml",
       "", "The exit code is 0 if there is a GPU that palpa can use, else 3. Mesa's driver for the processor counts."},
      add_options_of_doctor, [&program](const DoctorOptions& options) { run_doctor(options, program.extensions); },
      setup::Computes::on_processor);
}

}  // namespace palpa::cli
