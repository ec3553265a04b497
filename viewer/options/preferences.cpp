#include "viewer/options/preferences.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <exception>
#include <system_error>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/files/toml.hpp"
#include "base/log.hpp"

namespace palpa::viewer {

std::optional<std::filesystem::path> preferences_file() {
  const auto under = [](const char* variable) -> std::filesystem::path {
    const char* value = std::getenv(variable);
    return value != nullptr && value[0] == '/' ? value : "";
  };
  std::filesystem::path folder = under("XDG_CONFIG_HOME");
  if (folder.empty() && !under("HOME").empty()) folder = under("HOME") / ".config";
  if (folder.empty()) return std::nullopt;
  return folder / "palpa" / "viewer.toml";
}

namespace {

constexpr const char *unfolded = "unfolded", *folded = "folded", *recent_files = "recent";

std::vector<std::string> texts_or_none(TomlTable& table, const char* key) {
  return table.has(key) ? table.texts(key) : std::vector<std::string>();
}

WindowPlace load_window(TomlTable window) {
  const auto place = [&](const char* key) { return static_cast<int>(window.number(key, -30000, 30000)); };
  const auto size = [&](const char* key) { return static_cast<std::uint32_t>(window.whole(key, 16, 16384)); };
  const WindowPlace out{place("x"), place("y"), size("width"), size("height")};
  window.done();
  return out;
}

std::string list_of(const char* key, const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items)
    text += (text.empty() ? "" : ", ") + toml_string(item);
  return items.empty() ? "" : fmt::format("{} = [{}]\n", key, text);
}

}  // namespace

Preferences load_preferences(const std::filesystem::path& file) {
  Preferences settings;
  add_own_file(file);
  std::error_code fault;
  if (!std::filesystem::exists(file, fault) && !fault) return settings;
  TomlTable table = TomlTable::load(file, "the viewer's settings", {.bytes = 1U << 16, .items = 1000});
  settings.dark = table.flag_or("dark", settings.dark);
  settings.panels = table.flag_or("panels", settings.panels);
  const auto choice = [&](const char* key, const auto& words, auto& value) {
    const std::string word = table.text_or(key, std::string(word_of(words, value)));
    const auto known = value_of(words, word);
    if (!known) throw table.fault(key, fmt::format("{} is '{}': give {}", key, word, one_of(words)));
    value = *known;
  };
  choice("fine_pictures", fine_words, settings.fine);
  choice("finger_colour", skin_colour_words, settings.skin_colour);
  settings.slots_per_s = table.number_or("slots_per_s", settings.slots_per_s, 0.5, 667);
  for (const std::string& name : texts_or_none(table, unfolded))
    settings.headings[name] = true;
  for (const std::string& name : texts_or_none(table, folded))
    settings.headings[name] = false;
  settings.recent = texts_or_none(table, recent_files);
  if (std::optional<TomlTable> window = table.table("window")) settings.window = load_window(std::move(*window));
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

std::optional<WindowPlace> remembered_window(const std::filesystem::path& file) {
  try {
    return load_preferences(file).window;
  } catch (const Error&) {  // App, which loads all of it, reports that
    return std::nullopt;
  }
}

void warn_of_preferences(const std::filesystem::path& file) {
  try {
    load_preferences(file);
  } catch (const Error& error) {
    log::warning(fmt::format("{}; a picture without a window does not use it", error.what()));
  }
}

void save_preferences(const std::filesystem::path& file, const Preferences& settings) {
  std::error_code fault;
  std::filesystem::create_directories(file.parent_path(), fault);
  if (fault) throw failure(fmt::format("{}: cannot be created: {}", file.parent_path().string(), fault.message()));
  std::string text = fmt::format(
      "# How palpa-viewer looked when it was closed.\ndark = {}\npanels = {}\nfine_pictures = \"{}\"\n"
      "finger_colour = \"{}\"\nslots_per_s = {}\n",
      settings.dark, settings.panels, word_of(fine_words, settings.fine),
      word_of(skin_colour_words, settings.skin_colour), settings.slots_per_s);
  std::vector<std::string> open, closed;
  for (const auto& [name, is_open] : settings.headings)
    (is_open ? open : closed).push_back(name);
  text += list_of(unfolded, open) + list_of(folded, closed) + list_of(recent_files, settings.recent);
  if (const auto& window = settings.window) {
    text += fmt::format("[window]\nx = {}\ny = {}\nwidth = {}\nheight = {}\n", window->x, window->y, window->width,
                        window->height);
  }
  for (const Word<Layer>& entry : layer_words) {
    const LayerState& state = settings.layers[entry.value];
    text += fmt::format("[layers.{}]\nvisible = {}\nopacity = {}\n", entry.word, state.visible, state.opacity);
  }
  add_own_file(file);
  write_file(file, text);
}

Preferences to_remember(const Preferences& before, const Preferences& began, const Preferences& now) {
  Preferences out = before;
  const auto take = [](auto& value, const auto& at_first, const auto& at_last) {
    if (at_last != at_first) value = at_last;
  };
  const auto take_all = [&](auto... members) { (take(out.*members, began.*members, now.*members), ...); };
  take_all(&Preferences::dark, &Preferences::panels, &Preferences::fine, &Preferences::skin_colour,
           &Preferences::slots_per_s, &Preferences::headings, &Preferences::window, &Preferences::recent);
  for (const Word<Layer>& entry : layer_words) {
    take(out.layers[entry.value].visible, began.layers[entry.value].visible, now.layers[entry.value].visible);
    take(out.layers[entry.value].opacity, began.layers[entry.value].opacity, now.layers[entry.value].opacity);
  }
  return out;
}

void PreferencesMemory::remember(const Preferences& now) {
  if (!remembers()) return;
  const Preferences next = to_remember(recalled_, began_, now);
  if (next == recalled_) return;
  Preferences wanted = next;  // without what changes by itself, of whose loss nobody needs to hear
  wanted.window = recalled_.window;
  wanted.recent = recalled_.recent;
  const bool tell = wanted != recalled_;
  recalled_ = next;  // tried once: if it cannot be written, there is one warning
  try {
    save_preferences(file_, next);
  } catch (const std::exception& error) {
    if (tell) log::warning(error.what());
  }
}

}  // namespace palpa::viewer
