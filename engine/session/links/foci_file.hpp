// The foci of a run as a file.
//
// `.json`: {"slot_s": 0.0015, "frames": [{"slot": 0, "time_s": ..., "fingers": [...]}, ...]}. Each of "frames" is a
// line of the stream of foci (session/links/foci_link.hpp) plus the first slot that plays it.
//
// `.csv`: slot,time_s,finger,solid,focus,x,y,z,gain, one row per focus. `focus` is its number in the finger's list of
// foci; x, y, z are its place in the world, in metres. A frame without fingers has no row.
#pragma once

#include <memory>
#include <string>

#include "session/links/link.hpp"

namespace palpa::session {

class FociFile : public Link {
 public:
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}
  bool plays() const override { return false; }
  /// Moves the finished file into its place after success. Without this call, no file is created and an existing file
  /// stays. Throws failure() if the file cannot be written.
  virtual void commit() = 0;
};

/// "-" is JSON on stdout. Throws bad_usage for another ending, failure() if the file cannot be written.
std::unique_ptr<FociFile> open_foci_file(const std::string& file, const LinkSetting& setting);

/// Throws bad_usage for an ending other than these two.
void check_foci_file(const std::string& file);

}  // namespace palpa::session
