#include "base/outputs.hpp"

#include <fmt/core.h>
#include <sys/stat.h>

#include <utility>

#include "base/error.hpp"
#include "base/file_register.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

/// An output and its place.
struct Placed {
  const Output* output;
  OutputPlace place;
};

Placed placed(const Output& output) {
  if (output.kind == Output::Kind::file) return {&output, output_place(output.target)};
  // "take/" is the same as "take", and "-" is a folder like any other.
  const fs::path folder = fs::path(output.target) / "";
  OutputPlace place = output_place(fs::path(".") / folder.parent_path());
  place.name = output.target;
  return {&output, std::move(place)};
}

void refuse_unusable(const Placed& one) {
  const OutputPlace& place = one.place;
  if (one.output->kind == Output::Kind::file || place.kind != OutputPlace::Kind::folder) {
    if (one.output->kind == Output::Kind::folder && place.kind != OutputPlace::Kind::absent) {
      throw failure(fmt::format("{}: cannot be created: it is a file; name a new folder", place.name));
    }
    return refuse_unwritable(place);
  }
  std::error_code fault;
  if (one.output->full != Output::Full::replaced && !fs::is_empty(place.path, fault) && !fault) {
    throw bad_usage(fmt::format("{}: {} is not empty; name a new folder{}", one.output->option, place.name,
                                one.output->full == Output::Full::may_be_replaced
                                    ? ", or give --overwrite to replace the recording in it"
                                    : ""));
  }
}

bool lies_within(const Placed& one, const Placed& folder) {
  if (folder.output->kind != Output::Kind::folder || folder.place.kind != OutputPlace::Kind::folder) return false;
  std::error_code fault;
  for (fs::path at = fs::canonical(one.place.folder(), fault); !fault; at = at.parent_path()) {
    if (output_place(at).identity == folder.place.identity) return true;
    if (at == at.root_path()) break;
  }
  return false;
}

/// Devices and pipes are never the same output.
bool is_same(const OutputPlace& a, const OutputPlace& b) {
  if (a.kind != b.kind || a.kind == OutputPlace::Kind::other || a.identity != b.identity) return false;
  return a.kind != OutputPlace::Kind::absent || a.path.filename() == b.path.filename();
}

void refuse_pair(const Placed& a, const Placed& b) {
  const std::string both = fmt::format("{} and {}", a.output->option, b.output->option);
  const auto on_stdout = [](const Placed& one) {
    return one.output->kind == Output::Kind::file && one.place.is_stdout;
  };
  if (on_stdout(a) && on_stdout(b)) throw bad_usage(both + " would mix on stdout: give one of them a file");
  if (is_same(a.place, b.place)) {
    throw bad_usage(fmt::format("{} name the same file, {}: give each its own", both, b.place.name));
  }
  if (lies_within(a, b) || lies_within(b, a)) {
    throw bad_usage(fmt::format("{}: one lies in the folder of the other: give one of them another place", both));
  }
}

}  // namespace

Outputs::Outputs(const std::vector<Output>& outputs) {
  std::vector<Placed> all;
  for (const Output& output : outputs) {
    if (output.target.empty()) continue;
    all.push_back(placed(output));
    on_stdout_ = on_stdout_ || (output.kind == Output::Kind::file && all.back().place.is_stdout);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      refuse_pair(all[j], all[i]);
  }
  for (const Placed& one : all)
    refuse_unusable(one);
  std::vector<file_register::Claim> claims;
  claims.reserve(all.size());
  for (Placed& one : all)
    claims.push_back({this, one.output->option, std::move(one.place), one.output->kind == Output::Kind::folder,
                      one.output->full == Output::Full::replaced});
  file_register::claim(std::move(claims));
}

Outputs::~Outputs() {
  file_register::release(this);
}

void refuse_output_as_input(const fs::path& file) {
  if (file.empty() || !file_register::is_in_use()) return;
  struct stat status {};
  const bool there = ::stat(file.c_str(), &status) == 0;
  if (there && !S_ISREG(status.st_mode)) return;
  file_register::reads(file, there ? FileIdentity{status.st_dev, status.st_ino} : FileIdentity{});
}

}  // namespace palpa
