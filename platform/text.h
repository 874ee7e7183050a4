// platform/text.h — the few things that every room does with characters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace freshet {

/// A to Z as a to z; all other bytes stay, whatever the locale.
inline std::string lower_case(std::string text) {
  for (char& letter : text)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return text;
}

/// A file name's ending in lower case, with its dot; "" when it has none.
inline std::string lower_ending(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

/// Two lower-case hexadecimal digits a byte.
inline std::string hex(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

/// The 16 digits of a number, the greatest first.
inline std::string hex(std::uint64_t number) {
  std::uint8_t bytes[8];
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<std::uint8_t>(number >> (56 - 8 * i));
  return hex(bytes);
}

}  // namespace freshet
