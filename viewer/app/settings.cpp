#include "viewer/app/settings.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <exception>
#include <system_error>

#include "base/error.hpp"
#include "base/file_register.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "base/toml.hpp"

namespace palpa::viewer {

std::optional<std::filesystem::path> settings_file() {
  const auto under = [](const char* variable) -> std::filesystem::path {
    const char* value = std::getenv(variable);
    return value != nullptr && value[0] == '/' ? value : "";
  };
  std::filesystem::path folder = under("XDG_CONFIG_HOME");
  if (folder.empty() && !under("HOME").empty()) folder = under("HOME") / ".config";
  if (folder.empty()) return std::nullopt;
  return folder / "palpa" / "viewer.toml";
}

Settings load_settings(const std::filesystem::path& file) {
  Settings settings;
  file_register::add_own(file);
  std::error_code fault;
  if (!std::filesystem::exists(file, fault) && !fault) return settings;
  TomlTable table = TomlTable::load(file, "the viewer's settings", {.bytes = 1U << 16, .items = 1000});
  settings.dark = table.flag_or("dark", settings.dark);
  settings.panels = table.flag_or("panels", settings.panels);
  constexpr const char* fine = "fine_pictures";
  if (const std::string word = table.text_or(fine, std::string(word_of(fine_words, settings.fine)));
      const std::optional<FinePictures> known = value_of(fine_words, word)) {
    settings.fine = *known;
  } else {
    throw table.fault(fine, fmt::format("{} is '{}': give {}", fine, word, one_of(fine_words)));
  }
  settings.slots_per_s = table.number_or("slots_per_s", settings.slots_per_s, 0.5, 667);
  if (std::optional<TomlTable> layers = table.table("layers")) {
    for (const Word<Layer>& entry : layer_words) {
      LayerState& state = settings.layers[entry.value];
      std::optional<TomlTable> layer = layers->table(entry.word);
      if (!layer) continue;
      state.visible = layer->flag_or("visible", state.visible);
      state.opacity = static_cast<float>(layer->number_or("opacity", state.opacity, 0, 1));
      layer->done();
    }
    layers->done();
  }
  table.done();
  return settings;
}

void warn_of_settings(const std::filesystem::path& file) {
  try {
    load_settings(file);
  } catch (const Error& error) {
    log::warning(fmt::format("{}; a picture without a window does not use it", error.what()));
  }
}

void save_settings(const std::filesystem::path& file, const Settings& settings) {
  std::error_code fault;
  std::filesystem::create_directories(file.parent_path(), fault);
  if (fault) throw failure(fmt::format("{}: cannot be created: {}", file.parent_path().string(), fault.message()));
  std::string text = fmt::format(
      "# How palpa-viewer looked when it was closed.\ndark = {}\npanels = {}\nfine_pictures = \"{}\"\nslots_per_s = "
      "{}\n",
      settings.dark, settings.panels, word_of(fine_words, settings.fine), settings.slots_per_s);
  for (const Word<Layer>& entry : layer_words) {
    const LayerState& state = settings.layers[entry.value];
    text += fmt::format("[layers.{}]\nvisible = {}\nopacity = {}\n", entry.word, state.visible, state.opacity);
  }
  file_register::add_own(file);
  OutputFile out(file);
  out.write(text);
  out.finish();
}

Settings to_remember(const Settings& before, const Settings& began, const Settings& now) {
  Settings out = before;
  const auto take = [](auto& value, const auto& at_first, const auto& at_last) {
    if (at_last != at_first) value = at_last;
  };
  take(out.dark, began.dark, now.dark);
  take(out.panels, began.panels, now.panels);
  take(out.fine, began.fine, now.fine);
  take(out.slots_per_s, began.slots_per_s, now.slots_per_s);
  for (const Word<Layer>& entry : layer_words) {
    take(out.layers[entry.value].visible, began.layers[entry.value].visible, now.layers[entry.value].visible);
    take(out.layers[entry.value].opacity, began.layers[entry.value].opacity, now.layers[entry.value].opacity);
  }
  return out;
}

void SettingsMemory::remember(const Settings& now) {
  if (!remembers()) return;
  const Settings next = to_remember(recalled_, began_, now);
  if (next == recalled_) return;
  recalled_ = next;  // tried once: if it cannot be written, there is one warning
  try {
    save_settings(file_, next);
  } catch (const std::exception& error) {
    log::warning(error.what());
  }
}

}  // namespace palpa::viewer
