#include "synth/toml/keys.h"

#include <algorithm>

namespace freshet::synth {
namespace {

constexpr std::size_t kNameColumn = 15, kUsualColumn = 9, kLongestLine = 116;

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

}  // namespace

std::string key_lines(const std::vector<KeyText>& keys) {
  std::string text;
  for (const KeyText& key : keys) {
    std::string line = padded(padded(key.name, kNameColumn) + key.usual, kNameColumn + kUsualColumn);
    const std::size_t indent = kNameColumn + kUsualColumn;
    for (std::size_t at = 0; at < key.help.size();) {
      const std::size_t end = std::min(key.help.find(' ', at), key.help.size());
      const std::string word = key.help.substr(at, end - at);
      if (line.size() + word.size() > kLongestLine) {
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
        line = std::string(indent, ' ');
      }
      line += word + " ";
      at = end + 1;
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace freshet::synth
