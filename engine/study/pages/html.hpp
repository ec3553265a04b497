// A page of HTML with everything in it: no other file, no script, and legible on paper.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpa::study {

using HtmlRow = std::vector<std::string>;

/// All texts are escaped; figures are SVG and are put in as they are.
class HtmlPage {
 public:
  explicit HtmlPage(std::string_view title);

  void heading(std::string_view words);
  void paragraph(std::string_view words);
  /// The first row is the head, and the first cell of each row is its name.
  void table(std::string_view caption, const std::vector<HtmlRow>& rows);
  void figure(const std::string& svg, std::string_view caption);
  void list(const std::vector<std::string>& lines);

  /// The whole page.
  std::string finish();

 private:
  std::string text_;
};

}  // namespace palpa::study
