// The foci of a run as a file. `.json`: {"slot_s": 0.0015, "frames": [{"slot": 0, "time_s": ..., "fingers": [...]},
// ...]}, each of "frames" being a line of the stream of foci (session/links/foci_link.hpp) and the first slot that
// plays it.
// `.csv`: slot,time_s,finger,solid,focus,x,y,z,gain, a row per focus: its number in the finger's list of foci and
// its place in the world, metres. A frame without fingers has no row.
#pragma once

#include <memory>
#include <string>

#include "session/links/link.hpp"

namespace palpa::session {

class FociFile : public Link {
 public:
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}
  /// Puts the file into its place, once all went well: without it there is none, and one that was there stays. Throws
  /// failure() where it cannot be written.
  virtual void commit() = 0;
};

/// "-" is JSON on stdout. Throws bad_usage for another ending, failure() where the file cannot be written.
std::unique_ptr<FociFile> open_foci_file(const std::string& file, const LinkSetting& setting);

/// Throws bad_usage for another ending than these two.
void check_foci_file(const std::string& file);

}  // namespace palpa::session
