#include "session/links/link.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <system_error>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "session/links/foci_link.hpp"
#include "session/links/record_link.hpp"
#include "session/links/spec.hpp"

namespace palpa::session {
namespace {

/// Accepts all calls and does nothing, for a loop without an array.
class NullLink : public Link {
 public:
  void plan(const PlayedPlan&) override {}
  void send(std::uint64_t, std::span<const array::TransducerDrive> drive) override { played_ += sounds(drive) ? 1 : 0; }
  bool plays() const override { return false; }
  std::optional<Carried> carried() const override { return Carried{.completed = {.drives = played_}}; }

 private:
  std::uint64_t played_ = 0;
};

}  // namespace

std::vector<LinkKind> builtin_links() {
  return {{"null", "null: drives go nowhere",
           [](const std::string& argument, const LinkSetting&) -> std::unique_ptr<Link> {
             if (!argument.empty()) throw bad_usage("link null takes no argument, not '" + argument + "'");
             return std::make_unique<NullLink>();
           }},
          {"record", "record:FILE: every drive into a file",
           [](const std::string& file, const LinkSetting& setting) { return open_record_link(file, setting); }, true},
          {"foci", "foci:udp:HOST:PORT: one JSON line per frame with the foci", open_foci_link}};
}

void check_board_files(const std::string& spec, std::span<const LinkKind> kinds, const std::string& folder) {
  if (folder.empty()) return;
  const auto [name, argument] = parse_spec(spec);
  if (!find_kind(kinds, name, "link").reads_board_files) {
    throw bad_usage("--board-files goes with a link to boards that have their own files, such as openmpd:SERIAL; " +
                    name + " has none");
  }
  std::error_code ignored;  // the guard reports a folder that cannot be read
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    refuse_output_as_input(entry.path());
}

std::unique_ptr<Link> open_link(const std::string& spec, std::span<const LinkKind> kinds, const LinkSetting& setting) {
  const auto [name, argument] = parse_spec(spec);
  const LinkKind& kind = find_kind(kinds, name, "link");
  check_board_files(spec, kinds, setting.board_files);
  return kind.open(argument, setting);
}

std::string layout_of_link(const std::string& spec, std::span<const LinkKind> kinds) {
  const auto [name, argument] = parse_spec(spec);
  const LinkKind& kind = find_kind(kinds, name, "link");
  return kind.own_layout ? kind.own_layout(argument) : std::string();
}

double least_moving_slot_s(const std::string& spec, std::span<const LinkKind> kinds, const array::Layout& layout) {
  const auto [name, argument] = parse_spec(spec);
  const LinkKind& kind = find_kind(kinds, name, "link");
  return kind.least_moving_slot_s ? kind.least_moving_slot_s(argument, layout) : 0;
}

void check_takes_steps(const std::string& spec, std::span<const LinkKind> kinds) {
  const std::string name = parse_spec(spec).name;
  if (find_kind(kinds, name, "link").takes_steps) return;
  throw bad_usage("--steps goes with a link to boards that take steps, openmpd:SERIAL; " + name + " takes none");
}

std::string file_of_link(const std::string& spec, std::span<const LinkKind> kinds) {
  const auto [name, argument] = parse_spec(spec);
  return find_kind(kinds, name, "link").writes_file ? argument : std::string();
}

}  // namespace palpa::session
