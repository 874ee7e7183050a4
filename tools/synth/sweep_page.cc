#include "tools/synth/sweep_page.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "report/html_text.h"
#include "report/page.h"
#include "report/sheet_words.h"

namespace freshet::tools {
namespace {

using report::html_text;

constexpr int kCell = 480, kMinCell = 200, kGap = 8;  // px

// In an address, all characters except the plainest in hexadecimal.
std::string address_of(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '_')
      out += c;
    else
      out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

// clang-format off
constexpr std::string_view kTemplate =
#include "embedded/sweep_page.html"
    ;
// clang-format on

std::string figure_of(const SweptAnimation& animation) {
  return fmt::format(
      "<figure><div class=\"view\"><video src=\"{}\" loop muted playsinline preload=\"auto\" "
      "aria-label=\"{}\"></video></div><figcaption><b>{} {}</b>{}</figcaption></figure>\n",
      address_of(animation.video), html_text(animation.title), animation.number, html_text(animation.title),
      html_text(animation.result));
}

std::vector<std::string> cells_of(const SweptAnimation& animation) {
  const auto link = [](const std::string& file, const char* name) {
    return fmt::format("<a href=\"{}\">{}</a>", address_of(file), name);
  };
  return {animation.number,
          html_text(animation.title),
          html_text(animation.result),
          fmt::format("{:.3f}", animation.energy),
          std::isfinite(animation.gap) ? fmt::format("{:.2f}%", 100 * animation.gap) : "-",
          link(animation.file, "animation") + " " + link(animation.assignment, "patches"),
          "<code>" + html_text(animation.command) + "</code>"};
}

}  // namespace

cv::Mat sweep_sheet(const SweepWords& words, const cv::Mat& still,
                    const std::vector<SweptAnimation>& animations) {
  const cv::Size crop = words.region.size();
  const double scale = std::min({1.0, 1.0 * kCell / crop.width, 1.0 * kCell / crop.height});
  const cv::Size picture(std::max(1, cvRound(crop.width * scale)), std::max(1, cvRound(crop.height * scale)));
  std::vector<cv::Mat> cells;
  cv::Size cell(std::max(picture.width, kMinCell), 0);
  const auto add = [&](const cv::Mat& shown, const std::vector<std::string>& below) {
    cv::Mat place(picture.height, cell.width, CV_8UC3, cv::Scalar::all(report::kSheetPaper));
    cv::resize(shown(words.region), place(cv::Rect({}, picture)), picture, 0, 0, cv::INTER_AREA);
    cells.push_back(report::with_legend(place, below));
    cell.height = std::max(cell.height, cells.back().rows);
  };
  add(still, {"the still"});
  for (const SweptAnimation& animation : animations)
    if (animation.same_as < 0)
      add(animation.frame, {animation.number + "  " + animation.title, animation.result});
  const int count = static_cast<int>(cells.size()), width = cell.width + kGap, height = cell.height + kGap;
  const int columns = std::clamp(cvCeil(std::sqrt(1.0 * count * height / width)), 1, count);
  const int rows = (count + columns - 1) / columns;
  cv::Mat sheet(rows * height + kGap, columns * width + kGap, CV_8UC3, cv::Scalar::all(report::kSheetPaper));
  for (int i = 0; i < count; ++i) {
    const cv::Mat& shown = cells[static_cast<std::size_t>(i)];
    shown.copyTo(sheet(cv::Rect({i % columns * width + kGap, i / columns * height + kGap}, shown.size())));
  }
  std::vector<std::string> legend{
      fmt::format("{}: the still, then frame {} of each.", words.title, words.frame),
      report::crop_words(words.region, words.size)};
  legend.insert(legend.end(), words.axes.begin(), words.axes.end());
  for (const SweptAnimation& animation : animations)
    if (animation.same_as >= 0)
      legend.push_back(fmt::format("{}  {}: {}.", animation.number, animation.title, animation.result));
  return report::with_legend(sheet, legend);
}

std::string sweep_page(const SweepWords& words, const std::vector<SweptAnimation>& animations) {
  std::string axes;
  for (const std::string& axis : words.axes) axes += "<li>" + html_text(axis) + "</li>\n";
  std::string figures;
  report::HtmlTable table({"", "settings", "what came out", "energy", "gap", "files", "alone"});
  for (const SweptAnimation& animation : animations) {
    if (animation.same_as < 0) figures += figure_of(animation);
    table.add(cells_of(animation));
  }
  const cv::Rect& crop = words.region;
  const auto percent = [](double share) { return fmt::format("{:.4f}", 100 * share); };
  return report::page_html(
      words.title, report::filled(kTemplate, {{"column", std::to_string(std::clamp(crop.width, 240, 460))},
                                              {"axes", axes},
                                              {"still", address_of(words.still)},
                                              {"width", std::to_string(words.size.width)},
                                              {"height", std::to_string(words.size.height)},
                                              {"crop_width", std::to_string(crop.width)},
                                              {"crop_height", std::to_string(crop.height)},
                                              {"view_width", percent(1.0 * words.size.width / crop.width)},
                                              {"view_left", percent(-1.0 * crop.x / crop.width)},
                                              {"view_top", percent(-1.0 * crop.y / crop.height)},
                                              {"figures", figures},
                                              {"table", table.html()},
                                              {"fps", fmt::format("{}", words.fps)}}));
}

}  // namespace freshet::tools
