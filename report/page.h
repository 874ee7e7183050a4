// report/page.h — pages for a person: head, theme and tables, once for all.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace freshet::report {

/// A page in one file, as light or dark as the reader's system; charts (to_svg) have their colours in it.
/// title   any text; it is also the first line. body   HTML below it; it may begin with a <style> of its own.
std::string page_html(std::string_view title, std::string_view body);

/// A template with each {{name}} in it filled. Values are HTML, and are not looked into.
/// Names of the template that have no value stay, and those of values that the template does not ask for are passed
/// over.
std::string filled(std::string_view text,
                   const std::vector<std::pair<std::string_view, std::string>>& values);

/// A table that scrolls sideways where a screen is narrow. The first column is of words, the others of figures.
class HtmlTable {
 public:
  /// Heads and cells are HTML.
  explicit HtmlTable(const std::vector<std::string>& heads);
  void add(const std::vector<std::string>& cells);
  std::string html() const;

 private:
  std::string rows_;
};

}  // namespace freshet::report
