// hints/svg_style.h — which elements of an SVG document are not shown.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace freshet::hints {

/// What a style says about being shown; empty: nothing.
struct SvgShowing {
  std::optional<bool> displayed, visible, opaque;
};

/// "display:none; opacity:0", as in a style attribute or a rule. Anything else in it is passed over.
SvgShowing parse_svg_style(std::string_view declarations);
/// What `over` says, and else what `under` says.
SvgShowing overlaid(const SvgShowing& over, const SvgShowing& under);

/// The rules of a document's <style> elements whose selector is a single .class or #id: all that drawing
/// programs write. Others are passed over.
class SvgStyleSheet {
 public:
  void add(std::string_view text);
  /// classes   separated by spaces.
  SvgShowing of(std::string_view classes, std::string_view id) const;

 private:
  std::map<std::string, SvgShowing, std::less<>> rules_;  // by selector: ".hidden", "#layer1"
};

}  // namespace freshet::hints
