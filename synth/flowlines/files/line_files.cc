#include "synth/flowlines/files/line_files.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"
#include "hints/strokes.h"

namespace freshet::synth::flowlines {
namespace {

constexpr float kSlack = 1;                       // px beyond the border that a hand may draw
constexpr float kSlowest = 0.05f, kFastest = 20;  // times the clip's speed
constexpr int kWritten = 6;                       // px between the points of a written path

/// path "fall", part 2 -> fall-2; nothing where there is no id.
std::string id_of(const std::string& name) {
  const std::size_t open = name.find('"'), close = name.rfind('"');
  if (open == std::string::npos || close <= open) return "";
  const std::size_t part = name.find(", part ", close);
  const std::string id = name.substr(open + 1, close - open - 1);
  return part == std::string::npos ? id : fmt::format("{}-{}", id, name.substr(part + 7));
}

/// What of a chain lies in the picture: one piece.
std::vector<cv::Point2f> inside_of(const std::vector<cv::Point2f>& chain, cv::Size picture,
                                   const std::string& where) {
  const auto inside = [&](cv::Point2f p) {
    return p.x >= -kSlack && p.y >= -kSlack && p.x <= static_cast<float>(picture.width) - 1 + kSlack &&
           p.y <= static_cast<float>(picture.height) - 1 + kSlack;
  };
  std::vector<cv::Point2f> kept;
  bool left = false;
  for (const cv::Point2f& point : chain) {
    if (!inside(point)) {
      left = left || !kept.empty();
      continue;
    }
    if (left)
      throw Error(
          ErrorKind::kInput, where,
          fmt::format("this line leaves the picture and comes back at {:.0f},{:.0f}", point.x, point.y),
          "The clip shows no fluid out there: draw two lines, each inside the picture");
    kept.push_back(point);
  }
  return kept;
}

/// Speeds along the line; it may be stretched so far, or pressed together.
std::vector<float> speeds_of(const hints::Stroke& stroke, const std::string& where) {
  std::vector<float> speeds = stroke.speeds;
  if (speeds.empty() && stroke.speed_px_per_s) speeds.push_back(*stroke.speed_px_per_s);
  for (const float speed : speeds)
    if (!(speed >= kSlowest && speed <= kFastest))
      throw Error(ErrorKind::kInput, where,
                  fmt::format("its speed is {:.6g}; {:.6g} to {:.6g} times the clip's are expected", speed,
                              kSlowest, kFastest),
                  "data-speed=\"2\" is twice as fast; data-speed=\"1 2 .5\" changes along the line");
  return speeds;
}

}  // namespace

std::vector<FlowLine> read_lines(const std::filesystem::path& path, cv::Size picture, double shortest_px,
                                 std::vector<std::string>* notices) {
  std::vector<FlowLine> lines;
  std::set<std::string> names;
  for (const hints::Stroke& stroke : hints::read_strokes(path, picture, notices)) {
    std::vector<cv::Point2f> chain = stroke.points;
    for (cv::Point2f& point : chain) point -= cv::Point2f(0.5f, 0.5f);
    std::string name = stroke.line.empty() ? id_of(stroke.name) : stroke.line;
    if (name.empty()) name = fmt::format("line {}", lines.size() + 1);
    const std::string where = fmt::format("{}: \"{}\"", path.string(), name);
    // At even steps first: a long straight stretch may go out and in between two points.
    const FlowLine whole = evenly(chain, name);
    FlowLine line = evenly(inside_of(whole.points, picture, where), name);
    if (line.points.empty() || static_cast<double>(line.length()) < shortest_px)
      throw Error(
          ErrorKind::kInput, where,
          fmt::format(
              "inside the picture this line is {:.0f} px long, at least {:.0f} (half a patch) are needed",
              line.points.empty() ? 0.0f : line.length(), shortest_px),
          "Draw it longer, or lower --patch");
    if (line.samples() + 2 < whole.samples() && notices != nullptr)
      notices->push_back(fmt::format("\"{}\" leaves the picture: {:.0f} of its {:.0f} px were cut off", name,
                                     whole.length() - line.length(), whole.length()));
    if (!names.insert(name).second && !stroke.time_s)
      throw Error(ErrorKind::kInput, where, "two lines have this name",
                  "Give each an id of its own; or a data-time in seconds, where it is one line that moves");
    line.speeds = speeds_of(stroke, where);
    line.time_s = stroke.time_s;
    lines.push_back(std::move(line));
  }
  return lines;
}

void write_lines(const std::filesystem::path& path, const std::vector<FlowLine>& lines, cv::Size picture) {
  std::ofstream out(path);
  out << fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
      "<g fill=\"none\" stroke=\"#20a0ff\" stroke-width=\"{2}\">\n",
      picture.width, picture.height, std::max(1, picture.width / 400));
  for (const FlowLine& line : lines) {
    std::string d;
    for (int s = 0; s < line.samples(); s += kWritten) {
      const cv::Point2f p = line.points[static_cast<std::size_t>(s)];
      d += fmt::format("{}{:.2f},{:.2f}", s == 0 ? "M" : " L", p.x + 0.5f, p.y + 0.5f);
    }
    const cv::Point2f last = line.points.back();
    const std::string speeds =
        line.speeds.empty() ? "" : fmt::format(" data-speed=\"{:.4g}\"", fmt::join(line.speeds, " "));
    out << fmt::format("<path id=\"{}\"{} d=\"{} L{:.2f},{:.2f}\"/>\n", line.name, speeds, d, last.x + 0.5f,
                       last.y + 0.5f);
  }
  out << "</g>\n</svg>\n";
  out.close();
  if (!out) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
}

}  // namespace freshet::synth::flowlines
