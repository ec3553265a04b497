#include "cli/doctor.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "gpu/device.hpp"

namespace palpa::cli {
namespace {

struct DoctorOptions {
  setup::CommonOptions common;
};

constexpr const char* driver_advice =
    "install a Vulkan driver: apt-get install mesa-vulkan-drivers (it includes a CPU one)";

DoctorSection look_at_gpus() {
  DoctorSection section{"gpus", "GPUs", {}, {}};
  for (const gpu::DeviceDescription& device : gpu::list_devices()) {
    DoctorItem item;
    item.title = fmt::format("{} {}", device.index, device.name);
    item.ok = device.unusable.empty();
    item.advice = device.unusable;
    item.facts = {{"index", std::int64_t{device.index}},
                  {"name", device.name},
                  {"driver", device.driver},
                  {"kind", device.kind},
                  {"usable", item.ok}};
    section.items.push_back(std::move(item));
  }
  if (section.items.empty()) section.note = fmt::format("none found: {}", driver_advice);
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
      // Index, name and verdict stand in the title already.
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

std::string to_json(const std::vector<DoctorSection>& sections, bool ok) {
  JsonWriter json;
  json.begin_object().member("ok", ok);
  for (const DoctorSection& section : sections)
    append_json(json, section);
  json.key("notes").begin_object();
  for (const DoctorSection& section : sections) {
    if (!section.note.empty()) json.member(section.key, section.note);
  }
  json.end_object().end_object();
  return json.take();
}

void run_doctor(const DoctorOptions& options, const std::vector<DoctorProbe>& probes) {
  const Outputs outputs({{"--json", options.common.json}});
  std::vector<DoctorSection> sections{look_at_gpus(), look_at_validation()};
  for (const DoctorProbe& probe : probes)
    sections.push_back(probe());
  const bool ok = usable_gpu(sections.front());

  if (!options.common.json.empty()) write_file(options.common.json, to_json(sections, ok));
  if (setup::shows_summary(options.common, outputs)) {
    std::string text;
    for (const DoctorSection& section : sections)
      append_text(text, section);
    text += ok ? "palpa can run here.\n" : "palpa can only compute on the CPU here (--backend cpu).\n";
    write_file("-", text);
  }
  if (!ok) throw Error(Exit::no_device, fmt::format("no usable Vulkan device: {}", driver_advice));
}

}  // namespace

void add_doctor(Program& program) {
  add_subcommand<DoctorOptions>(
      program,
      {"doctor", "what works on this machine, and what to do about the rest",
       "  palpa doctor\n  palpa doctor --json -\n"
       "Exit code 0 when there is a GPU that palpa can use (the CPU driver of Mesa counts), else 3."},
      [](CLI::App&, DoctorOptions&) {},
      [&program](const DoctorOptions& options) { run_doctor(options, program.extensions.doctor); });
}

}  // namespace palpa::cli
