#include "study/pages/html.hpp"

#include <fmt/format.h>

#include <cstddef>

#include "study/pages/svg.hpp"

namespace palpa::study {
namespace {

constexpr std::string_view style =
    "body{font:15px/1.45 sans-serif;color:#111;background:#fff;max-width:60em;margin:2em auto;padding:0 1em}\n"
    "h1{font-size:1.6em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #999}\n"
    "table{border-collapse:collapse;margin:1em 0}caption,figcaption{text-align:left;font-size:.93em;color:#333;"
    "padding:.3em 0}\n"
    "th,td{border:1px solid #aaa;padding:.2em "
    ".6em;text-align:right}th{background:#eee}th:first-child{text-align:left}\n"
    "figure{margin:1em 0}svg{max-width:100%;height:auto}\n"
    "@media print{body{font-size:10.5pt;max-width:none;margin:0}h2{break-after:avoid}figure,table{break-inside:avoid}"
    "th{background:none}rect{print-color-adjust:exact;-webkit-print-color-adjust:exact}}\n";

}  // namespace

HtmlPage::HtmlPage(std::string_view title)
    : text_(fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n"
                        "<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n{1}</style>\n</head>\n"
                        "<body>\n<h1>{0}</h1>\n",
                        escaped(title), style)) {}

void HtmlPage::heading(std::string_view words) {
  text_ += fmt::format("<h2>{}</h2>\n", escaped(words));
}

void HtmlPage::paragraph(std::string_view words) {
  text_ += fmt::format("<p>{}</p>\n", escaped(words));
}

void HtmlPage::table(std::string_view caption, const std::vector<HtmlRow>& rows) {
  text_ += fmt::format("<table>\n<caption>{}</caption>\n", escaped(caption));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text_ += "<tr>";
    for (std::size_t j = 0; j < rows[i].size(); ++j) {
      const char* kind = i == 0 || j == 0 ? "th" : "td";
      text_ += fmt::format("<{0}>{1}</{0}>", kind, escaped(rows[i][j]));
    }
    text_ += "</tr>\n";
  }
  text_ += "</table>\n";
}

void HtmlPage::figure(const std::string& svg, std::string_view caption) {
  text_ += fmt::format("<figure>\n{}<figcaption>{}</figcaption>\n</figure>\n", svg, escaped(caption));
}

void HtmlPage::list(const std::vector<std::string>& lines) {
  text_ += "<ul>\n";
  for (const std::string& line : lines)
    text_ += fmt::format("<li>{}</li>\n", escaped(line));
  text_ += "</ul>\n";
}

std::string HtmlPage::finish() {
  return text_ + "</body>\n</html>\n";
}

}  // namespace palpa::study
