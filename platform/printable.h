// platform/printable.h — names and messages that may be shown to a person, whatever bytes they are made of.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace freshet {

namespace printing {

/// Bytes of the UTF-8 character that `text` begins with, and its number; 0 bytes where it begins with none.
struct Character {
  std::size_t bytes = 0;
  char32_t number = 0;
};
inline Character first_character(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = at(0);
  const std::size_t bytes = lead < 0x80       ? 1
                            : lead >> 5 == 6  ? 2
                            : lead >> 4 == 14 ? 3
                            : lead >> 3 == 30 ? 4
                                              : 0;
  if (bytes == 0 || bytes > text.size()) return {};
  char32_t number = bytes == 1 ? lead : lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (at(i) >> 6 != 2) return {};
    number = number << 6 | (at(i) & 0x3f);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = number >= 0xd800 && number < 0xe000;
  return number < kLeast[bytes] || number > 0x10ffff || surrogate ? Character{} : Character{bytes, number};
}

/// Moves the cursor, rings, colours, or turns the direction of writing.
inline bool controls(char32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

inline std::string escaped(std::string_view text, std::string_view kept) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const Character c = first_character(text.substr(i));
    const std::size_t bytes = c.bytes == 0 ? 1 : c.bytes;
    const bool plain = c.bytes > 0 && (!controls(c.number) || kept.find(text[i]) != std::string_view::npos);
    for (std::size_t end = i + bytes; i < end; ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      if (plain)
        out += text[i];
      else
        out.append({'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]});
    }
  }
  return out;
}

}  // namespace printing

/// In one line: bytes that are no UTF-8, and characters that would control a terminal, stand as \xNN.
inline std::string printable(std::string_view text) { return printing::escaped(text, ""); }
/// The same, where lines are meant.
inline std::string printable_lines(std::string_view text) { return printing::escaped(text, "\n"); }

}  // namespace freshet
