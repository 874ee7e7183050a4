#include "report/page.h"

#include <algorithm>

#include "report/curve_chart.h"
#include "report/html_text.h"

namespace freshet::report {
namespace {

// clang-format off
constexpr std::string_view kPage =
#include "embedded/page.html"
    ;
// clang-format on

}  // namespace

std::string filled(std::string_view text,
                   const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = std::min(text.find("{{", at), text.size());
    out += text.substr(at, open - at);
    const std::size_t close = text.find("}}", open);
    if (close == std::string_view::npos) return out += text.substr(open);
    const std::string_view name = text.substr(open + 2, close - open - 2);
    const auto value = std::ranges::find(values, name, [](const auto& each) { return each.first; });
    out += value == values.end() ? std::string(text.substr(open, close + 2 - open)) : value->second;
    at = close + 2;
  }
  return out;
}

std::string page_html(std::string_view title, std::string_view body) {
  return filled(kPage, {{"title", html_text(title)}, {"charts", chart_style()}, {"body", std::string(body)}});
}

HtmlTable::HtmlTable(const std::vector<std::string>& heads) {
  rows_ = "<thead><tr>";
  for (const std::string& head : heads) rows_ += "<th scope=\"col\">" + head + "</th>";
  rows_ += "</tr></thead>\n<tbody>\n";
}

void HtmlTable::add(const std::vector<std::string>& cells) {
  rows_ += "<tr>";
  for (const std::string& cell : cells) rows_ += "<td>" + cell + "</td>";
  rows_ += "</tr>\n";
}

std::string HtmlTable::html() const {
  return "<div class=\"wide\"><table>\n" + rows_ + "</tbody>\n</table></div>\n";
}

}  // namespace freshet::report
