// The options of a single touch while the user changes them.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// Holds the values and also the command line that gives them (`given`). Both always change together. After changes,
/// check() says whether they go together.
class TouchEdit {
 public:
  explicit TouchEdit(ViewerOptions options) : options_(std::move(options)) {}

  const ViewerOptions& options() const { return options_; }
  /// Throws bad_usage if the options do not go together. Warns about unusual ones.
  void check() const;

  /// The scene is in this file from now on. For another file, clears options that only concern the contents of the one
  /// before.
  void open_scene(const std::string& file);
  /// The skin is in this file of points from now on, and no longer in depth images.
  void use_points(const std::string& file);
  /// Sets the option to the text of a field, as LiveEdit::set; nullopt restores the default. Throws bad_usage for a
  /// text that is not a value of the option, and then changes nothing.
  void set(const std::string& option, const std::optional<std::string>& text);

 private:
  ViewerOptions options_;
};

}  // namespace palpa::viewer
