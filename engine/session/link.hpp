// A link is where drives go: a board, an emulator, a recorder, a stream of foci, nothing. Links are interchangeable by
// name and behave alike; docs/add-a-link.md shows how to write one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"

namespace palpa::session {

/// What a link is told when it is opened. The referenced values outlive the link.
struct LinkSetting {
  const array::Layout& layout;               ///< as posed in the world
  std::span<const std::string> solid_names;  ///< by solid index
  double slot_s = 1.5e-3;                    ///< one drive lasts that long
};

/// All calls come from one thread, the output thread. A link that can fail throws Error: the loop then sends silence,
/// ends and reports it. The loop promises that an all-zero drive is the last that any link gets, on every path.
class Link {
 public:
  virtual ~Link() = default;

  /// New foci, once per frame, before their first drive; no voices mean that nothing is touched. Also told when foci
  /// expire.
  virtual void foci(const array::Schedule& schedule) = 0;

  /// The drive of slot `slot`, one entry per transducer in layout order, at the slot's time. Called for every slot;
  /// slots that the output thread overslept are skipped, so numbers ascend but may leap.
  virtual void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) = 0;

  /// After the last drive: hands over what is still buffered. Errors here are reported, too.
  virtual void finish() {}
};

/// A kind of link: `name` or `name:ARGUMENT` on the command line.
struct LinkKind {
  std::string name;
  std::string help;  ///< "record:FILE  every drive into a file"
  std::function<std::unique_ptr<Link>(const std::string& argument, const LinkSetting&)> open;
};

/// `null`, `record`, `foci`.
std::vector<LinkKind> builtin_links();

/// Opens "name" or "name:argument". Throws bad_usage with the known names for an unknown one.
std::unique_ptr<Link> open_link(const std::string& spec, std::span<const LinkKind> kinds, const LinkSetting& setting);

}  // namespace palpa::session
