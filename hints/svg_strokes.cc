#include "hints/svg_strokes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pugixml.hpp>

#include "freshet/error.h"
#include "hints/svg_path.h"
#include "hints/svg_scanner.h"
#include "hints/svg_style.h"
#include "hints/svg_transform.h"

namespace freshet::hints {
namespace {

constexpr int kDeepest = 200;                 // elements in each other
constexpr std::size_t kMaxPoints = 3u << 20;  // of all curves together
constexpr double kSameProportions = 0.02;
constexpr std::size_t kMostSpeeds = 100, kMostPositions = 1000;  // of a line
constexpr double kTolerance = 0.1;  // px of the picture, of a chain that stands for a curve

bool same_proportions(cv::Size2d a, cv::Size2d b) {
  const double ratio = (a.width * b.height) / (a.height * b.width);
  return std::isfinite(ratio) && std::abs(std::log(ratio)) <= kSameProportions;
}

/// What attributes say of the strokes below them.
struct Said {
  std::vector<float> speeds;
  std::optional<float> time_s;
  std::string line;
};

/// "2.5", "2.5s" or "2500ms".
float seconds(const std::string& text) {
  SvgScanner scanner(text);
  const double number = scanner.number();
  const std::string_view unit = scanner.word();
  if (!scanner.at_end() || !(unit.empty() || unit == "s" || unit == "ms") || !(number >= 0 && number < 1e6))
    throw SvgFault("seconds are expected, from 0 on: \"2.5\", or \"2.5s\"");
  return static_cast<float>(unit == "ms" ? number / 1000 : number);
}

/// What elements inherit.
struct Context {
  cv::Matx33d to_page = cv::Matx33d::eye();  // from user units to px of the page
  cv::Size2d user;                           // size of the viewport in user units, for per cent
  Said said;
  std::vector<std::string> names;  // of groups and the element, outermost first
  std::string layer;
  bool displayed = true, visible = true;
  int depth = 0;
};

/// A stroke before it is known where the picture lies.
struct Drawn {
  SvgSubpath line;  // px of the page
  std::string name;
  Said said;
  std::vector<std::string> names;
  std::string layer;
};

class Document {
 public:
  Document(std::string_view text, const std::string& where, cv::Size picture);
  std::vector<Stroke> strokes(std::vector<std::string>* notices);

 private:
  [[noreturn]] void fail(const std::string& fault,
                         const std::string& remedy = "Save it again as plain SVG") const {
    throw Error(ErrorKind::kInput, where_, fault, remedy);
  }
  /// Runs what reads an attribute; its fault becomes an Error that names the element.
  template <class Read>
  auto reading(const pugi::xml_node& node, const char* attribute, Read&& read) const {
    try {
      return read();
    } catch (const SvgFault& fault) {
      fail(fmt::format("{} of {}: {}", attribute, label(node), fault.what()));
    }
  }
  double length(const pugi::xml_node& node, const char* name, double whole, double otherwise) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    const char* text = attribute.value();
    if (*text == '\0' || std::strcmp(text, "auto") == 0) return otherwise;
    return reading(node, name, [&] { return svg_length(text, whole); });
  }
  std::optional<cv::Rect2d> view_box(const pugi::xml_node& node) const;
  std::string local_name(const pugi::xml_node& node) const;
  std::string label(const pugi::xml_node& node) const {
    const std::string id = node.attribute("id").value();
    return local_name(node) + (id.empty() ? "" : " \"" + id.substr(0, 60) + "\"");
  }

  void read_styles(const pugi::xml_node& node, int depth);
  void walk(const pugi::xml_node& node, const Context& parent);
  void walk_children(const pugi::xml_node& node, const Context& context) {
    for (const pugi::xml_node& child : node.children()) walk(child, context);
  }
  Context context_of(const pugi::xml_node& node, const Context& parent) const;
  void read_said(const pugi::xml_node& node, Said& said) const;
  void draw_animated(const pugi::xml_node& path, const pugi::xml_node& animate, Context context);
  void enter_document(const pugi::xml_node& node, Context& context) const;
  void note_image(const pugi::xml_node& node, const Context& context);
  void draw(const pugi::xml_node& node, const Context& context, std::vector<SvgSubpath> lines);
  cv::Matx33d picture_from_page() const;

  std::string where_;
  cv::Size picture_;
  pugi::xml_document xml_;
  std::string prefix_;  // of SVG's names, with its colon
  SvgStyleSheet styles_;
  cv::Size2d page_;
  bool page_is_given_ = false;
  std::vector<Drawn> drawn_;
  std::size_t points_ = 0;
  std::set<std::string> left_out_;
  double image_area_ = 0;  // px of the page; of the largest image that may be the picture
  cv::Matx33d page_from_picture_;
};

Document::Document(std::string_view text, const std::string& where, cv::Size picture)
    : where_(where), picture_(picture) {
  const pugi::xml_parse_result parsed = xml_.load_buffer(text.data(), text.size());
  if (!parsed) fail(fmt::format("not a whole XML file: {}, at byte {}", parsed.description(), parsed.offset));
  const pugi::xml_node root = xml_.document_element();
  const std::string name = root.name();
  const std::size_t colon = name.find(':');
  prefix_ = colon == std::string::npos ? "" : name.substr(0, colon + 1);
  if (local_name(root) != "svg") fail("an XML file, but not SVG: its root is " + name.substr(0, 60));

  const std::optional<cv::Rect2d> box = view_box(root);
  // The page: as wide as it says, as wide as its view box, or the picture.
  const auto percent = [&](const char* side) {
    return std::strchr(root.attribute(side).value(), '%') != nullptr;
  };
  const double width = percent("width") ? 0 : length(root, "width", 0, 0),
               height = percent("height") ? 0 : length(root, "height", 0, 0);
  page_is_given_ = box.has_value() || (width > 0 && height > 0);
  page_ = box ? box->size() : cv::Size2d(picture);
  if (width > 0 && height > 0)
    page_ = {width, height};
  else if (width > 0 && box)
    page_ = {width, width * box->height / box->width};
  else if (height > 0 && box)
    page_ = {height * box->width / box->height, height};

  Context context;
  context.user = box ? box->size() : page_;
  if (box) context.to_page = svg_viewport(*box, page_, root.attribute("preserveAspectRatio").value());
  read_styles(root, 0);
  walk_children(root, context_of(root, context));
}

std::string Document::local_name(const pugi::xml_node& node) const {
  const std::string name = node.name();
  if (!name.starts_with(prefix_)) return "";
  const std::string local = name.substr(prefix_.size());
  return local.find(':') == std::string::npos ? local : "";
}

std::optional<cv::Rect2d> Document::view_box(const pugi::xml_node& node) const {
  const char* text = node.attribute("viewBox").value();
  if (*text == '\0') return {};
  return reading(node, "viewBox", [&] {
    SvgScanner scanner(text);
    cv::Rect2d box;
    for (double* value : {&box.x, &box.y, &box.width, &box.height}) *value = scanner.number();
    if (!(box.width > 0 && box.height > 0)) throw SvgFault("it has no area");
    return box;
  });
}

void Document::read_styles(const pugi::xml_node& node, int depth) {
  if (depth > kDeepest) return;  // walk() refuses it
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    if (local_name(child) == "style")
      for (const pugi::xml_node& text : child.children()) styles_.add(text.value());
    else
      read_styles(child, depth + 1);
  }
}

void Document::read_said(const pugi::xml_node& node, Said& said) const {
  if (const char* text = node.attribute("data-speed").value(); *text != '\0')
    said.speeds = reading(node, "data-speed", [&] {
      SvgScanner scanner(text);
      std::vector<float> speeds;
      do speeds.push_back(static_cast<float>(scanner.number()));
      while (scanner.starts_number() && speeds.size() < kMostSpeeds);
      if (!scanner.at_end())
        throw SvgFault("a number of px/s is expected, without a unit, or some dozens of them");
      return speeds;
    });
  if (const char* text = node.attribute("data-time").value(); *text != '\0')
    said.time_s = reading(node, "data-time", [&] { return seconds(text); });
  if (const char* text = node.attribute("data-of").value(); *text != '\0') said.line = text;
}

/// A path that an <animate> moves: a position a value.
void Document::draw_animated(const pugi::xml_node& path, const pugi::xml_node& animate, Context context) {
  const auto list = [](const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t from = 0; from <= text.size();) {
      const std::size_t end = std::min(text.find(';', from), text.size());
      if (text.find_first_not_of(" \t\r\n", from) < end) parts.push_back(text.substr(from, end - from));
      from = end + 1;
    }
    return parts;
  };
  const std::vector<std::string> values = list(animate.attribute("values").value()),
                                 times = list(animate.attribute("keyTimes").value());
  reading(animate, "values", [&] {
    if (values.size() < 2 || values.size() > kMostPositions)
      throw SvgFault(fmt::format("it has {} positions, 2 to {} expected", values.size(), kMostPositions));
    if (!times.empty() && times.size() != values.size())
      throw SvgFault(fmt::format("there are {} keyTimes for {} positions", times.size(), values.size()));
    const float length = seconds(animate.attribute("dur").value());
    context.said.line = path.attribute("id").value();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto even = static_cast<double>(i) / static_cast<double>(values.size() - 1);
      context.said.time_s = length * static_cast<float>(times.empty() ? even : SvgScanner(times[i]).number());
      draw(path, context, parse_svg_path(values[i]));
    }
  });
}

Context Document::context_of(const pugi::xml_node& node, const Context& parent) const {
  Context context = parent;
  ++context.depth;
  if (const char* text = node.attribute("transform").value(); *text != '\0')
    context.to_page = context.to_page * reading(node, "transform", [&] { return parse_svg_transform(text); });
  read_said(node, context.said);
  // Drawing programs write the name that a person gave as a label, as the id, or as both.
  for (const char* attribute : {"inkscape:label", "id"})
    if (const char* text = node.attribute(attribute).value(); *text != '\0') context.names.emplace_back(text);
  if (const char* text = node.attribute("data-layer").value(); *text != '\0') context.layer = text;
  SvgShowing showing;
  for (const char* name : {"display", "visibility", "opacity"}) {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (attribute) showing = overlaid(parse_svg_style(std::string(name) + ":" + attribute.value()), showing);
  }
  showing = overlaid(styles_.of(node.attribute("class").value(), node.attribute("id").value()), showing);
  showing = overlaid(parse_svg_style(node.attribute("style").value()), showing);
  context.displayed = parent.displayed && showing.displayed.value_or(true) && showing.opaque.value_or(true);
  context.visible = showing.visible.value_or(parent.visible);
  return context;
}

/// An <svg> in the document has a place, a size and units of its own.
void Document::enter_document(const pugi::xml_node& node, Context& context) const {
  const double x = length(node, "x", context.user.width, 0), y = length(node, "y", context.user.height, 0);
  const cv::Size2d size(length(node, "width", context.user.width, context.user.width),
                        length(node, "height", context.user.height, context.user.height));
  context.to_page = context.to_page * cv::Matx33d(1, 0, x, 0, 1, y, 0, 0, 1);
  context.user = size;
  const std::optional<cv::Rect2d> box = view_box(node);
  if (!box) return;
  context.to_page = context.to_page * svg_viewport(*box, size, node.attribute("preserveAspectRatio").value());
  context.user = box->size();
}

/// Remembers the largest image of the picture's proportions: programs put strokes on top of the picture.
void Document::note_image(const pugi::xml_node& node, const Context& context) {
  const cv::Size2d size(length(node, "width", context.user.width, picture_.width),
                        length(node, "height", context.user.height, picture_.height));
  if (!(size.width > 0 && size.height > 0) || !same_proportions(size, picture_)) return;
  const cv::Matx33d corner(1, 0, length(node, "x", context.user.width, 0), 0, 1,
                           length(node, "y", context.user.height, 0), 0, 0, 1);
  const cv::Matx33d placed =
      context.to_page * corner *
      svg_viewport({0, 0, static_cast<double>(picture_.width), static_cast<double>(picture_.height)}, size,
                   node.attribute("preserveAspectRatio").value());
  const double area = std::abs(placed(0, 0) * placed(1, 1) - placed(0, 1) * placed(1, 0)) * picture_.area();
  if (!(area > image_area_)) return;
  image_area_ = area;
  page_from_picture_ = placed;
}

void Document::draw(const pugi::xml_node& node, const Context& context, std::vector<SvgSubpath> lines) {
  if (!context.displayed || !context.visible) return;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    points_ += lines[i].points.size();
    if (points_ > kMaxPoints) fail("it has more than a million curves", "Draw fewer and simpler strokes");
    for (cv::Point2d& point : lines[i].points) point = transformed(context.to_page, point);
    drawn_.push_back({std::move(lines[i]),
                      label(node) + (lines.size() > 1 ? fmt::format(", part {}", i + 1) : ""), context.said,
                      context.names, context.layer});
  }
}

void Document::walk(const pugi::xml_node& node, const Context& parent) {
  if (node.type() != pugi::node_element) return;
  if (parent.depth > kDeepest) fail(fmt::format("elements are nested deeper than {}", kDeepest));
  const std::string name = local_name(node);
  const bool group = name == "g" || name == "a" || name == "switch" || name == "svg";
  const bool line = name == "path" || name == "line" || name == "polyline" || name == "polygon";
  const bool shape =
      name == "rect" || name == "circle" || name == "ellipse" || name == "use" || name == "text";
  if (!group && !line && !shape && name != "image") return;

  Context context = context_of(node, parent);
  if (group) {
    if (name == "svg") enter_document(node, context);
    walk_children(node, context);
  } else if (name == "image") {
    note_image(node, context);
  } else if (shape) {
    if (context.displayed && context.visible) left_out_.insert(name);
  } else if (name == "path") {
    pugi::xml_node animate;
    for (const pugi::xml_node& child : node.children())
      if (local_name(child) == "animate" && std::strcmp(child.attribute("attributeName").value(), "d") == 0)
        animate = child;
    if (animate)
      draw_animated(node, animate, context);
    else
      draw(node, context, reading(node, "d", [&] { return parse_svg_path(node.attribute("d").value()); }));
  } else {
    std::vector<cv::Point2d> corners;
    if (name == "line") {
      const auto at = [&](const char* x, const char* y) {
        return cv::Point2d(length(node, x, context.user.width, 0), length(node, y, context.user.height, 0));
      };
      corners = {at("x1", "y1"), at("x2", "y2")};
    } else {
      corners = reading(node, "points", [&] { return parse_svg_points(node.attribute("points").value()); });
    }
    if (name == "polygon" && !corners.empty()) corners.push_back(corners[0]);
    if (corners.size() < 2) return;
    SvgSubpath chain{{corners[0]}};
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const cv::Point2d from = corners[i - 1], way = corners[i] - from;
      chain.points.insert(chain.points.end(), {from + way / 3.0, from + way * (2.0 / 3.0), corners[i]});
    }
    draw(node, context, {std::move(chain)});
  }
}

cv::Matx33d Document::picture_from_page() const {
  if (image_area_ > 0) {
    bool possible = false;
    const cv::Matx33d inverse = page_from_picture_.inv(cv::DECOMP_LU, &possible);
    if (possible) return inverse;
  }
  if (!page_is_given_) return cv::Matx33d::eye();
  if (!same_proportions(page_, picture_))
    fail(fmt::format("its page is {:.6g} x {:.6g}, of other proportions than the picture's {} x {} px",
                     page_.width, page_.height, picture_.width, picture_.height),
         "Make the page as large as the picture, or leave the picture in the drawing, under its strokes");
  return {picture_.width / page_.width, 0, 0, 0, picture_.height / page_.height, 0, 0, 0, 1};
}

std::vector<Stroke> Document::strokes(std::vector<std::string>* notices) {
  const cv::Matx33d placed = picture_from_page();
  std::vector<Stroke> strokes;
  std::size_t points = 0;
  for (Drawn& drawn : drawn_) {
    for (cv::Point2d& point : drawn.line.points) {
      point = transformed(placed, point);
      if (!(std::abs(point.x) < 1e7 && std::abs(point.y) < 1e7))
        fail(drawn.name + " lies far outside the picture", "Remove it");
    }
    Stroke& stroke = strokes.emplace_back();
    stroke.points = flatten(drawn.line, kTolerance);
    stroke.name = std::move(drawn.name);
    stroke.names = std::move(drawn.names);
    stroke.layer = std::move(drawn.layer);
    stroke.time_s = drawn.said.time_s;
    stroke.line = std::move(drawn.said.line);
    if (!drawn.said.speeds.empty()) stroke.speed_px_per_s = drawn.said.speeds.front();
    if (drawn.said.speeds.size() > 1) stroke.speeds = std::move(drawn.said.speeds);
    points += strokes.back().points.size();
    if (points > kMaxPoints) fail("it has more than a million points", "Draw fewer and simpler strokes");
  }
  if (notices != nullptr && !left_out_.empty())
    notices->push_back(
        fmt::format("shapes without a beginning and an end are left out: {}", fmt::join(left_out_, ", ")));
  return strokes;
}

}  // namespace

std::vector<Stroke> read_svg_strokes(std::string_view text, const std::string& where, cv::Size picture,
                                     std::vector<std::string>* notices) {
  return Document(text, where, picture).strokes(notices);
}

}  // namespace freshet::hints
