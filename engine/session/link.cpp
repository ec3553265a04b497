#include "session/link.hpp"

#include "base/error.hpp"
#include "session/foci_link.hpp"
#include "session/record_link.hpp"
#include "session/spec.hpp"

namespace palpa::session {
namespace {

/// Takes everything and does nothing: the loop without an array.
class NullLink : public Link {
 public:
  void plan(const ToldPlan&) override {}
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}
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

std::unique_ptr<Link> open_link(const std::string& spec, std::span<const LinkKind> kinds, const LinkSetting& setting) {
  const auto [name, argument] = parse_spec(spec);
  return find_kind(kinds, name, "link").open(argument, setting);
}

std::string file_of_link(const std::string& spec, std::span<const LinkKind> kinds) {
  const auto [name, argument] = parse_spec(spec);
  return find_kind(kinds, name, "link").writes_file ? argument : std::string();
}

}  // namespace palpa::session
