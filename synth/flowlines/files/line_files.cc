#include "synth/flowlines/files/line_files.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "query/hints/motion_maps.h"
#include "query/hints/strokes.h"

namespace freshet::synth::flowlines {
namespace {

constexpr float kSlack = 1;  // px beyond the border that a hand may draw
constexpr int kWritten = 6;  // px between the points of a written path

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

}  // namespace

std::vector<FlowLine> read_lines(const std::filesystem::path& path, cv::Size picture, double shortest_px,
                                 std::vector<std::string>* notices) {
  std::vector<FlowLine> lines;
  std::set<std::string> names;
  for (const query::Stroke& stroke : query::read_strokes(path, picture, notices)) {
    std::vector<cv::Point2f> chain = stroke.points;
    for (cv::Point2f& point : chain) point -= cv::Point2f(0.5f, 0.5f);
    std::string name = id_of(stroke.name);
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
    if (!names.insert(name).second)
      throw Error(ErrorKind::kInput, where, "two lines have this name", "Give each an id of its own");
    if (stroke.speed_px_per_s) line.speed = static_cast<double>(*stroke.speed_px_per_s);
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
    out << fmt::format("<path id=\"{}\" d=\"{} L{:.2f},{:.2f}\"/>\n", line.name, d, last.x + 0.5f,
                       last.y + 0.5f);
  }
  out << "</g>\n</svg>\n";
  out.close();
  if (!out) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
}

cv::Mat draw_lines(const cv::Mat& picture, const cv::Mat& matte, const std::vector<FlowLine>& lines) {
  cv::Mat out = picture.clone(), dim = picture / 3;
  dim.copyTo(out, matte < 128);
  const int thick = std::max(1, picture.cols / 400);
  const int names_every = std::max(1, static_cast<int>(lines.size()) / 24);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const FlowLine& line = lines[i];
    for (int s = 0; s + 3 < line.samples(); s += 3) {
      const cv::Point2f along = tangent(line, s);
      const cv::Vec3f colour = query::colour_of_direction(cv::Vec2f(along.x, along.y)) * 255;
      cv::line(out, cv::Point(line.points[static_cast<std::size_t>(s)]),
               cv::Point(line.points[static_cast<std::size_t>(s) + 3]),
               cv::Scalar(colour[0], colour[1], colour[2]), thick, cv::LINE_AA);
    }
    const cv::Point2f end = line.points.back(), back = tangent(line, line.samples() - 1);
    cv::arrowedLine(out, cv::Point(end - back * 8.0f), cv::Point(end), cv::Scalar(255, 255, 255), thick,
                    cv::LINE_AA, 0, 0.6);
    cv::circle(out, cv::Point(line.points.front()), 2 * thick, cv::Scalar(255, 255, 255), cv::FILLED,
               cv::LINE_AA);
    if (i % static_cast<std::size_t>(names_every) == 0)
      cv::putText(out, line.name, cv::Point(line.points[line.points.size() / 3]), cv::FONT_HERSHEY_SIMPLEX,
                  0.35 * std::max(1.0, picture.cols / 640.0), cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  }
  return out;
}

}  // namespace freshet::synth::flowlines
