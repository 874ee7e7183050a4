#include "hints/svg_scanner.h"

#include <charconv>
#include <cmath>

namespace freshet::hints {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

void SvgScanner::skip_spaces() {
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
}

bool SvgScanner::at_end() {
  skip_spaces();
  return at_ >= text_.size();
}

char SvgScanner::peek() { return at_end() ? '\0' : text_[at_]; }

char SvgScanner::take() {
  const char c = peek();
  if (c != '\0') ++at_;
  return c;
}

void SvgScanner::skip_comma() {
  if (peek() == ',') ++at_;
  skip_spaces();
}

bool SvgScanner::starts_number() {
  const char c = peek();
  return is_digit(c) || c == '-' || c == '+' || c == '.';
}

double SvgScanner::number() {
  skip_spaces();
  // The grammar's own extent first: from_chars would also take "inf" and "nan".
  std::size_t end = at_;
  const auto digits = [&] {
    const std::size_t start = end;
    while (end < text_.size() && is_digit(text_[end])) ++end;
    return end - start;
  };
  if (end < text_.size() && (text_[end] == '-' || text_[end] == '+')) ++end;
  std::size_t count = digits();
  if (end < text_.size() && text_[end] == '.') {
    ++end;
    count += digits();
  }
  if (count == 0) throw SvgFault("a number is expected " + place());
  if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'E')) {
    const std::size_t mantissa = end;
    ++end;
    if (end < text_.size() && (text_[end] == '-' || text_[end] == '+')) ++end;
    if (digits() == 0) end = mantissa;  // of "em" or "ex"
  }
  const char* first = text_.data() + at_ + (text_[at_] == '+' ? 1 : 0);
  double value = 0;
  const auto [stop, fault] = std::from_chars(first, text_.data() + end, value);
  if (fault == std::errc::result_out_of_range) {
    // Too small counts as nothing, too large is refused below. "1e-400" has its sign in the exponent.
    const std::string_view written(first, static_cast<std::size_t>(text_.data() + end - first));
    value = written.find("e-") != std::string_view::npos || written.find("E-") != std::string_view::npos
                ? 0
                : 1e300;
  } else if (fault != std::errc() || stop != text_.data() + end) {
    throw SvgFault("a number is expected " + place());
  }
  if (std::abs(value) > 1e9) throw SvgFault("a number is out of range " + place());
  at_ = end;
  skip_comma();
  return value;
}

bool SvgScanner::flag() {
  const char c = take();
  if (c != '0' && c != '1') throw SvgFault("a flag of 0 or 1 is expected " + place());
  skip_comma();
  return c == '1';
}

std::string_view SvgScanner::word() {
  skip_spaces();
  const std::size_t start = at_;
  while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
  return text_.substr(start, at_ - start);
}

std::string SvgScanner::place() const { return "at character " + std::to_string(at_ + 1); }

double svg_length(std::string_view text, double whole) {
  SvgScanner scanner(text);
  const double value = scanner.number();
  double unit = 1;
  if (scanner.peek() == '%') {
    scanner.take();
    unit = whole / 100;
  } else if (const std::string_view name = scanner.word(); !name.empty()) {
    if (name == "px")
      unit = 1;
    else if (name == "pt")
      unit = 96.0 / 72;
    else if (name == "pc")
      unit = 16;
    else if (name == "mm")
      unit = 96 / 25.4;
    else if (name == "cm")
      unit = 96 / 2.54;
    else if (name == "in")
      unit = 96;
    else if (name == "Q")
      unit = 96 / 101.6;
    else if (name == "em")
      unit = 16;
    else if (name == "ex")
      unit = 8;
    else
      throw SvgFault("\"" + std::string(name) + "\" is no unit of length");
  }
  if (!scanner.at_end()) throw SvgFault("it does not end " + scanner.place());
  return value * unit;
}

}  // namespace freshet::hints
