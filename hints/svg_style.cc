#include "hints/svg_style.h"

#include <algorithm>
#include <cstdlib>

namespace freshet::hints {
namespace {

constexpr std::string_view kSpace = " \t\r\n\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Cuts off what stands before the separator, and the separator.
std::string_view take_until(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view head = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  return trimmed(head);
}

std::string without_comments(std::string_view text) {
  std::string kept;
  while (!text.empty()) {
    const std::size_t begin = text.find("/*");
    kept += text.substr(0, begin);
    if (begin == std::string_view::npos) break;
    const std::size_t end = text.find("*/", begin + 2);
    if (end == std::string_view::npos) break;
    text = text.substr(end + 2);
  }
  return kept;
}

}  // namespace

SvgShowing parse_svg_style(std::string_view declarations) {
  SvgShowing showing;
  while (!declarations.empty()) {
    std::string_view declaration = take_until(declarations, ';');
    const std::string_view name = take_until(declaration, ':'), value = take_until(declaration, '!');
    if (value.empty()) continue;
    if (name == "display") showing.displayed = value != "none";
    if (name == "visibility" && value != "inherit")
      showing.visible = value != "hidden" && value != "collapse";
    if (name == "opacity") showing.opaque = std::strtod(std::string(value).c_str(), nullptr) > 0;
  }
  return showing;
}

SvgShowing overlaid(const SvgShowing& over, const SvgShowing& under) {
  return {over.displayed ? over.displayed : under.displayed, over.visible ? over.visible : under.visible,
          over.opaque ? over.opaque : under.opaque};
}

void SvgStyleSheet::add(std::string_view text) {
  const std::string plain = without_comments(text);
  std::string_view rest = plain;
  while (!rest.empty()) {
    std::string_view selectors = take_until(rest, '{');
    const SvgShowing showing = parse_svg_style(take_until(rest, '}'));
    if (!showing.displayed && !showing.visible && !showing.opaque) continue;
    while (!selectors.empty()) {
      const std::string_view selector = take_until(selectors, ',');
      const bool simple = selector.size() > 1 && (selector[0] == '.' || selector[0] == '#') &&
                          selector.find_first_of(" .#:>+~[", 1) == std::string_view::npos;
      if (!simple) continue;
      SvgShowing& rule = rules_[std::string(selector)];
      rule = overlaid(showing, rule);
    }
  }
}

SvgShowing SvgStyleSheet::of(std::string_view classes, std::string_view id) const {
  SvgShowing by_class;
  std::string selector;
  for (std::string_view rest = trimmed(classes); !rest.empty(); rest = trimmed(rest)) {
    const std::size_t end = std::min(rest.find_first_of(kSpace), rest.size());
    selector.assign(1, '.').append(rest.substr(0, end));
    const auto rule = rules_.find(selector);
    if (rule != rules_.end()) by_class = overlaid(rule->second, by_class);
    rest = rest.substr(end);
  }
  selector.assign(1, '#').append(id);
  const auto rule = rules_.find(selector);
  return rule == rules_.end() ? by_class : overlaid(rule->second, by_class);
}

}  // namespace freshet::hints
