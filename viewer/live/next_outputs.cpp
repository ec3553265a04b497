#include "viewer/live/next_outputs.hpp"

#include <fmt/core.h>

#include <system_error>

#include "session/links/spec.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;

/// Whether it is a file or folder with something in it.
bool written(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return (fs::is_regular_file(status) || fs::is_directory(status)) && !fs::is_empty(path, ignored) && !ignored;
}

/// A folder's name has no extension, even if it looks like one.
fs::path numbered(const fs::path& path, unsigned number, bool folder) {
  fs::path name = folder ? path.filename() : path.stem();
  name += fmt::format("-{}", number);
  if (!folder) name += path.extension();
  return path.parent_path() / name;
}

}  // namespace

std::vector<std::string> NextOutputs::name(setup::LiveOptions& options, std::span<const session::LinkKind> links) {
  std::vector<std::string> lines;
  const auto next = [&](const char* option, std::string target, bool folder) {
    while (folder && target.size() > 1 && target.back() == '/')
      target.pop_back();
    const fs::path path = fs::absolute(target).lexically_normal();
    if (begun_.insert(path).second || !written(path)) return target;
    unsigned number = 2;
    std::error_code ignored;
    while (fs::exists(fs::symlink_status(numbered(path, number, folder), ignored)))
      ++number;
    std::string name = numbered(target, number, folder).string();
    begun_.insert(numbered(path, number, folder));
    lines.push_back(fmt::format("{}: {} is kept, this run writes {}", option, target, name));
    return name;
  };
  if (!options.events.empty() && options.events != "-" && !options.events.starts_with("udp:"))
    options.events = next("--events", options.events, false);
  if (!options.record.empty()) options.record = next("--record", options.record, true);
  const std::string file = session::file_of_link(options.link, links);
  if (!file.empty() && file != "-")
    options.link = session::parse_spec(options.link).name + ":" + next("--link", file, false);
  return lines;
}

}  // namespace palpa::viewer
