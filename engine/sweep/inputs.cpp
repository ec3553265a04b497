#include "sweep/inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/outputs.hpp"
#include "base/sha256.hpp"
#include "geometry/gltf_document/buffers.hpp"
#include "sensing/rig.hpp"
#include "sweep/commands.hpp"

namespace palpa::sweep {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::pair<std::string, std::string>>;  // as named, path

/// The JSON of a glTF file in either form; empty if there is none.
std::string gltf_json(const std::string& path) {
  constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
  const InputFile file(path, most_bytes);
  constexpr std::size_t heads = 20;  // of the file, and of its first chunk
  const std::string head = file.head(heads);
  if (!head.starts_with("glTF") || head.size() < heads) return read_file(path, most_bytes);
  std::uint32_t length = 0;
  std::memcpy(&length, head.data() + 12, sizeof(length));
  if (length > file.size() - heads) return {};
  std::string json(length, ' ');
  file.read_at(heads, {reinterpret_cast<unsigned char*>(json.data()), json.size()});
  return json;
}

/// The buffers in files of their own. The model's pictures change no result, but no output may replace them. Faults in
/// the model are found when it is loaded.
Names files_of_gltf(const std::string& path) {
  const auto document = nlohmann::json::parse(gltf_json(path), nullptr, false);
  Names names;
  for (const char* kind : {"buffers", "images"}) {
    if (!document.is_object() || !document.contains(kind) || !document[kind].is_array()) continue;
    for (const auto& item : document[kind]) {
      if (!item.is_object() || !item.contains("uri") || !item["uri"].is_string()) continue;
      const auto uri = geometry::gltf::decode_percent(item["uri"].get<std::string>());
      std::error_code ignored;
      if (!uri || uri->starts_with("data:")) continue;
      const fs::path file = fs::path(path).parent_path() / *uri;
      if (!fs::is_regular_file(file, ignored)) continue;
      refuse_output_as_input(file);
      if (std::string_view(kind) == "buffers") names.emplace_back(*uri, file.string());
    }
  }
  return names;
}

Names files_of_rig(const std::string& path) {
  const sensing::Rig rig = sensing::load_rig(path);
  Names names;
  for (const sensing::Camera& camera : rig.cameras) {
    if (camera.mask) names.emplace_back(camera.mask->file, camera.mask->file);
    if (camera.background) names.emplace_back(camera.background->file, camera.background->file);
  }
  std::error_code ignored;
  if (rig.array && fs::is_regular_file(rig.array->layout, ignored))
    names.emplace_back(rig.array->layout, rig.array->layout);
  return names;
}

Names named_in(const std::string& option, const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".gltf" || ending == ".glb") return files_of_gltf(path);
  if (option == "--rig" || option == "--camera") return files_of_rig(path);
  return {};
}

}  // namespace

Inputs::Inputs(const Plan& plan) : plan_(&plan) {
  for (const Setting& setting : plan.fixed)
    add(plan, setting);
  for (const Axis& axis : plan.axes) {
    for (const std::vector<Setting>& choice : axis.choices) {
      for (const Setting& setting : choice)
        add(plan, setting);
    }
  }
}

std::string Inputs::add_file(const std::string& name, const std::string& path) {
  const auto [known, is_new] = by_path_.emplace(path, files_.size());
  if (is_new) {
    const FileDigest digest = sha256_of_file(path);
    files_.push_back({name, path, digest.sha256, digest.bytes});
  }
  return files_[known->second].sha256;
}

void Inputs::add(const Plan& plan, const Setting& setting) {
  const std::vector<setup::OptionInfo>& options = command_of(plan.command).options;
  const setup::OptionInfo& option = *std::ranges::find(options, setting.option, &setup::OptionInfo::name);
  for (const std::string& value : setting.values) {
    const std::string named = file_in(option, value);
    if (named.empty() || paths_[option.name].contains(value)) continue;
    const std::string path = (fs::path(plan.folder) / named).string();
    // The value with a text in the place of the file.
    const auto with = [&](const std::string& text) {
      std::string changed = value;
      return changed.replace(value.find(named), named.size(), text);
    };
    try {
      // The ending decides how a file is read.
      std::string digest = fs::path(path).extension().string() + ":" + add_file(named, path);
      for (const auto& [name, file] : named_in(option.name, path))
        digest.append(",").append(add_file(name, file));
      paths_[option.name][value] = with(path);
      digests_[option.name][value] = with(digest);
    } catch (const Error& error) {
      if (error.code() != Exit::bad_input) throw;
      throw bad_input(plan.file, fmt::format("{}: {}", option.name.substr(2), error.what()));
    }
  }
}

std::vector<Setting> Inputs::resolved(std::vector<Setting> settings) const {
  for (Setting& setting : settings) {
    const auto paths = paths_.find(setting.option);
    if (paths == paths_.end()) continue;
    for (std::string& value : setting.values) {
      if (const auto path = paths->second.find(value); path != paths->second.end()) value = path->second;
    }
  }
  return settings;
}

std::string Inputs::canonical(const std::vector<Setting>& settings) const {
  std::vector<std::string> lines;
  for (const Setting& setting : settings) {
    if (!setting.given) continue;
    std::string line = setting.option;
    const auto digests = digests_.find(setting.option);
    for (const std::string& value : setting.values) {
      const bool is_file = digests != digests_.end() && digests->second.contains(value);
      const std::string& text = is_file ? digests->second.at(value) : value;
      line += fmt::format("\t{}:{}", text.size(), text);
    }
    lines.push_back(std::move(line));
  }
  std::ranges::sort(lines);
  std::string text;
  for (const std::string& line : lines)
    text += line + "\n";
  return text;
}

}  // namespace palpa::sweep
