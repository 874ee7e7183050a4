#include "hints/svg_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hints/svg_scanner.h"

namespace freshet::hints {
namespace {

using Point = cv::Point2d;

constexpr std::size_t kMaxPoints = 3u << 20;

// Builds subpaths as a pen that moves.
class Pen {
 public:
  Point at() const { return at_; }
  void move(Point to) {
    finish();
    start_ = at_ = to;
    subpath_.points.assign(1, to);
  }
  void line(Point to) { curve(at_ + (to - at_) / 3.0, at_ + (to - at_) * (2.0 / 3.0), to); }
  void curve(Point first, Point second, Point to) {
    // Behind a Z, drawing goes on from where the closed line began.
    if (subpath_.points.empty()) subpath_.points.assign(1, at_);
    subpath_.points.insert(subpath_.points.end(), {first, second, to});
    at_ = to;
    if ((total_ += 3) > kMaxPoints) throw SvgFault("it has more than a million curves");
  }
  void quadratic(Point control, Point to) {
    curve(at_ + (control - at_) * (2.0 / 3.0), to + (control - to) * (2.0 / 3.0), to);
  }
  void arc(double radius_x, double radius_y, double turned_deg, bool large, bool sweep, Point to);
  void close() {
    if (at_ != start_) line(start_);
    finish();
    at_ = start_;
  }
  std::vector<SvgSubpath> finished() {
    finish();
    return std::move(done_);
  }

 private:
  void finish() {
    if (subpath_.points.size() > 1) done_.push_back(std::move(subpath_));
    subpath_ = {};
  }
  std::vector<SvgSubpath> done_;
  SvgSubpath subpath_;
  Point at_, start_;
  std::size_t total_ = 0;
};

// SVG 1.1, appendix F.6: from end points to centre, then a cubic for each quarter at most.
void Pen::arc(double radius_x, double radius_y, double turned_deg, bool large, bool sweep, Point to) {
  radius_x = std::abs(radius_x);
  radius_y = std::abs(radius_y);
  if (to == at_) return;
  if (radius_x < 1e-12 || radius_y < 1e-12) return line(to);
  const double turned = turned_deg * std::numbers::pi / 180, c = std::cos(turned), s = std::sin(turned);
  const Point half = (at_ - to) / 2.0;
  const double x = c * half.x + s * half.y, y = -s * half.x + c * half.y;
  const double reach = x * x / (radius_x * radius_x) + y * y / (radius_y * radius_y);
  if (reach > 1) {
    radius_x *= std::sqrt(reach);
    radius_y *= std::sqrt(reach);
  }
  const double xx = radius_x * radius_x, yy = radius_y * radius_y;
  const double below = xx * y * y + yy * x * x;
  const double factor = (large == sweep ? -1 : 1) * std::sqrt(std::max(0.0, (xx * yy - below) / below));
  const Point centre_turned(factor * radius_x * y / radius_y, -factor * radius_y * x / radius_x);
  const Point centre(c * centre_turned.x - s * centre_turned.y + (at_.x + to.x) / 2,
                     s * centre_turned.x + c * centre_turned.y + (at_.y + to.y) / 2);
  const double first = std::atan2((y - centre_turned.y) / radius_y, (x - centre_turned.x) / radius_x);
  double angle = std::atan2((-y - centre_turned.y) / radius_y, (-x - centre_turned.x) / radius_x) - first;
  if (sweep && angle < 0) angle += 2 * std::numbers::pi;
  if (!sweep && angle > 0) angle -= 2 * std::numbers::pi;

  const int parts =
      std::clamp(static_cast<int>(std::ceil(std::abs(angle) / (std::numbers::pi / 2 + 1e-9))), 1, 4);
  const double step = angle / parts, handle = 4.0 / 3 * std::tan(step / 4);
  const auto on = [&](double a, double along) {  // the point at angle a, and `along` further on its tangent
    const double px = radius_x * (std::cos(a) - along * std::sin(a)),
                 py = radius_y * (std::sin(a) + along * std::cos(a));
    return Point(centre.x + c * px - s * py, centre.y + s * px + c * py);
  };
  for (int i = 0; i < parts; ++i) {
    const double from = first + i * step;
    curve(on(from, handle), on(from + step, -handle), i + 1 == parts ? to : on(from + step, 0));
  }
}

}  // namespace

std::vector<SvgSubpath> parse_svg_path(std::string_view d) {
  SvgScanner scanner(d);
  Pen pen;
  char command = '\0', last = '\0';
  Point control;  // of the curve before, for S and T
  if (!scanner.at_end() && scanner.peek() != 'M' && scanner.peek() != 'm')
    throw SvgFault("a path must begin with M");
  while (!scanner.at_end()) {
    if (!scanner.starts_number())
      command = scanner.take();
    else if (last == '\0' || last == 'Z' || last == 'z')
      throw SvgFault("a command is expected " + scanner.place());
    else if (command == 'M' || command == 'm')
      command = command == 'M' ? 'L' : 'l';  // pairs after the first are lines

    const bool relative = command >= 'a' && command <= 'z';
    const Point origin = relative ? pen.at() : Point(0, 0);
    const auto point = [&] {
      const double x = scanner.number();
      return origin + Point(x, scanner.number());
    };
    const char kind = relative ? static_cast<char>(command - 'a' + 'A') : command;
    const auto reflected = [&](char one, char other) {
      const char before = last >= 'a' && last <= 'z' ? static_cast<char>(last - 'a' + 'A') : last;
      return before == one || before == other ? pen.at() * 2.0 - control : pen.at();
    };
    switch (kind) {
      case 'M':
        pen.move(point());
        break;
      case 'L':
        pen.line(point());
        break;
      case 'H':
        pen.line({origin.x + scanner.number(), pen.at().y});
        break;
      case 'V':
        pen.line({pen.at().x, origin.y + scanner.number()});
        break;
      case 'C': {
        const Point first = point();
        control = point();
        pen.curve(first, control, point());
        break;
      }
      case 'S': {
        const Point first = reflected('C', 'S');
        control = point();
        pen.curve(first, control, point());
        break;
      }
      case 'Q':
        control = point();
        pen.quadratic(control, point());
        break;
      case 'T':
        control = reflected('Q', 'T');
        pen.quadratic(control, point());
        break;
      case 'A': {
        const double radius_x = scanner.number(), radius_y = scanner.number(), turned = scanner.number();
        const bool large = scanner.flag(), sweep = scanner.flag();
        pen.arc(radius_x, radius_y, turned, large, sweep, point());
        break;
      }
      case 'Z':
        pen.close();
        scanner.skip_comma();
        break;
      default:
        throw SvgFault("\"" + std::string(1, command) + "\" is no command of a path (" + scanner.place() +
                       ")");
    }
    last = command;
  }
  return pen.finished();
}

std::vector<cv::Point2d> parse_svg_points(std::string_view points) {
  SvgScanner scanner(points);
  std::vector<Point> found;
  while (!scanner.at_end()) {
    const double x = scanner.number();
    if (scanner.at_end()) throw SvgFault("a number without its pair");
    found.emplace_back(x, scanner.number());
    if (found.size() > kMaxPoints / 3) throw SvgFault("it has more than a million points");
  }
  return found;
}

std::vector<cv::Point2f> flatten(const SvgSubpath& subpath, double tolerance) {
  std::vector<cv::Point2f> chain;
  if (subpath.points.empty()) return chain;
  chain.emplace_back(subpath.points[0]);
  for (std::size_t i = 0; i + 3 < subpath.points.size(); i += 3) {
    const Point &a = subpath.points[i], &b = subpath.points[i + 1], &c = subpath.points[i + 2],
                &d = subpath.points[i + 3];
    // A chord over 1 / n of the parameter is off by at most 6 / 8 of the largest second difference / n^2.
    const double bend = std::max(cv::norm(a - 2.0 * b + c), cv::norm(b - 2.0 * c + d));
    const int parts = static_cast<int>(std::clamp(std::ceil(std::sqrt(0.75 * bend / tolerance)), 1.0, 256.0));
    for (int part = 1; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts, r = 1 - t;
      chain.emplace_back(a * (r * r * r) + b * (3 * r * r * t) + c * (3 * r * t * t) + d * (t * t * t));
    }
    chain.emplace_back(d);
    if (chain.size() > kMaxPoints) break;  // more than the caller takes
  }
  return chain;
}

}  // namespace freshet::hints
