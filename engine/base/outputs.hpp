// What a command is going to write, known before anything is read or opened, so that it never writes over what it
// reads.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/output_place.hpp"

namespace palpa {

/// One of a command's outputs, as the command line gave it.
struct Output {
  enum class Kind { file, folder };

  std::string option;  ///< "--json", for messages
  std::string target;  ///< a file, "-" for stdout, a new or empty folder; "" where there is none
  Kind kind = Kind::file;
};

/// The outputs of a command. While it lives, reading one of them is refused (by InputFile and refuse_output_as_input),
/// under whatever name, so a command that makes this first and opens outputs after all inputs cannot lose an input.
/// Devices and pipes may be read, and written twice. Where several live, each knows only its own.
class Outputs {
 public:
  /// Throws, before anything is changed, failure() for an output that cannot be written there, bad_usage for a folder
  /// that is not empty, for two that are the same file, for one within another's folder, and for two on stdout.
  explicit Outputs(const std::vector<Output>& outputs);
  ~Outputs();
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;

  /// Whether one of them is stdout: nothing else may be printed there.
  bool on_stdout() const { return on_stdout_; }

 private:
  bool on_stdout_ = false;
};

/// Throws bad_usage, naming the option, where that file is one of the living Outputs. `name` is for the message.
void refuse_output_as_input(const FileIdentity& identity, const std::string& name);
/// The same for a file that an input refers to, and that is read later or not at all; nothing where there is none.
void refuse_output_as_input(const std::filesystem::path& file);

}  // namespace palpa
