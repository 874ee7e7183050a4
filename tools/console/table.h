// tools/console/table.h — results as columns of text for a person.
#pragma once

#include <string>
#include <vector>

namespace freshet::tools {

/// Rows of cells under a header. Columns whose cells all begin with a digit, a sign or "-" are flush right.
class Table {
 public:
  explicit Table(std::vector<std::string> header);
  void row(std::vector<std::string> cells);
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// 1234567 -> "1.2 MB".
std::string bytes_text(double bytes);

}  // namespace freshet::tools
