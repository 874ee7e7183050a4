// hints/svg_scanner.h — numbers and words of SVG attributes, which need not be separated.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace freshet::hints {

/// What is wrong with an attribute's text; whoever knows the element turns it into an Error.
struct SvgFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads one attribute from left to right.
class SvgScanner {
 public:
  explicit SvgScanner(std::string_view text) : text_(text) {}

  bool at_end();              // behind spaces
  char peek();                // behind spaces; 0 at the end
  char take();                // what peek() showed
  void skip_comma();          // spaces, at most one comma, spaces
  bool starts_number();       // a digit, sign or point follows
  double number();            // and the comma behind it; throws SvgFault: none there, or above 1e9
  bool flag();                // 0 or 1, one character; and the comma behind it
  std::string_view word();    // letters, maybe none
  std::string place() const;  // "at character 12", for a fault

 private:
  void skip_spaces();
  std::string_view text_;
  std::size_t at_ = 0;
};

/// A length in px (96 to the inch): units px, pt, pc, mm, cm, in, Q, em, ex, or per cent of `whole`.
/// Throws SvgFault.
double svg_length(std::string_view text, double whole);

}  // namespace freshet::hints
