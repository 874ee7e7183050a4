#include "bench/quality/quality_page.h"

#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/video/video_writer.h"
#include "platform/whole_file.h"
#include "report/html_text.h"
#include "report/page.h"

namespace freshet::bench {
namespace {

using report::html_text;

constexpr int kPanel = 426;  // px, width of a panel; higher than wide ones are narrower

std::string file_name_of(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

media::VideoWriterOptions written_at(double fps, int crf) {
  return {.fps_num = std::lround(fps * 1000), .fps_den = 1000, .crf = crf};
}

cv::Mat annotated(const Case& asked, bool with_strokes) {
  cv::Mat picture = asked.still.clone();
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(cv::Mat(asked.matte > 127), outlines, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
  cv::drawContours(picture, outlines, -1, {255, 255, 0}, 1, cv::LINE_AA);
  for (const hints::Stroke& stroke : asked.strokes) {
    if (!with_strokes) break;
    for (std::size_t i = 1; i < stroke.points.size(); ++i) {
      const cv::Point a(stroke.points[i - 1]), b(stroke.points[i]);
      if (i + 1 == stroke.points.size())
        cv::arrowedLine(picture, a, b, {60, 60, 255}, 2, cv::LINE_AA, 0, 0.8);
      else
        cv::line(picture, a, b, {60, 60, 255}, 2, cv::LINE_AA);
    }
  }
  return picture;
}

// clang-format off
constexpr std::string_view kTemplate =
#include "embedded/quality_page.html"
    ;
// clang-format on

}  // namespace

std::string write_panels(const std::filesystem::path& folder, const Case& asked,
                         const std::vector<cv::Mat>& made, const std::string& method, bool with_strokes) {
  const cv::Size from = asked.still.size();
  const double scale = std::min(1.0 * kPanel / from.width, 1.0 * kPanel / from.height);
  const cv::Size panel(static_cast<int>(from.width * scale) / 2 * 2,
                       static_cast<int>(from.height * scale) / 2 * 2);
  const std::string name = file_name_of(asked.name + "_" + method) + ".mp4";
  cv::Mat sheet(panel.height, 3 * panel.width + 8, CV_8UC3, cv::Scalar::all(0)), small;
  const auto place = [&](const cv::Mat& picture, int column) {
    cv::resize(picture, small, panel, 0, 0, cv::INTER_AREA);
    small.copyTo(sheet(cv::Rect(column * (panel.width + 4), 0, panel.width, panel.height)));
  };
  place(annotated(asked, with_strokes), 2);
  media::VideoWriter writer(folder / name, sheet.size(), written_at(asked.fps, 20));
  for (std::size_t i = 0; i < made.size(); ++i) {
    place(asked.truth[i], 0);
    place(made[i], 1);
    writer.write(sheet);
  }
  writer.finish();
  return name;
}

void write_film(const std::filesystem::path& folder, const Case& asked, const std::string& method,
                const std::vector<cv::Mat>& frames) {
  const std::filesystem::path of_clip = folder / file_name_of(asked.name);
  std::filesystem::create_directories(of_clip);
  media::VideoWriter writer(of_clip / (file_name_of(method) + ".mp4"), frames.front().size(),
                            written_at(asked.fps, 12));
  for (const cv::Mat& frame : frames) writer.write(frame);
  writer.finish();
}

void write_page(const std::filesystem::path& folder, const std::vector<Judged>& judged,
                const std::string& title) {
  std::string cards;
  for (const Judged& one : judged) {
    if (one.video.empty()) continue;
    cards += fmt::format("<div class=\"card\" data-method=\"{}\"", html_text(one.method));
    for (const Figure& figure : figures())
      cards += fmt::format(" data-{}=\"{:.4f}\"", figure.key, figure.value(one.distance));
    cards +=
        fmt::format("><b>{}</b>, {}<video src=\"{}\" loop muted playsinline preload=\"metadata\"></video>",
                    html_text(one.clip), html_text(one.method), one.video);
    for (const Figure& figure : figures()) {
      const double value = figure.value(one.distance);
      if (!std::isnan(value))
        cards +=
            fmt::format("<span class=\"figure\"><i>{}</i> {}</span>", figure.head, to_string(figure, value));
    }
    cards += "</div>\n";
  }
  nlohmann::json keys = nlohmann::json::array();
  for (const Figure& figure : figures()) keys.push_back({figure.key, figure.head, figure.more_is_better});
  write_whole_file(
      folder / "index.html",
      report::page_html(title, report::filled(kTemplate, {{"cards", cards},
                                                          {"summary", html_text(summary_table(judged))},
                                                          {"clips", html_text(clip_table(judged))},
                                                          {"figures", keys.dump()}})));
}

}  // namespace freshet::bench
