#include "synth/stills/stills_page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "report/data_address.h"
#include "report/html_text.h"
#include "report/page.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {
namespace {

using report::html_text;

constexpr int kThumb = 120;                 // px, longer side
constexpr int kWidth = 900, kHeight = 560;  // px, of a graph
constexpr const char* kColours[] = {"#d1495b", "#00798c", "#edae49", "#6a4c93",
                                    "#30638e", "#8ac926", "#ff7f11", "#3d5a80"};

std::string picture_address(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 82});
  return report::data_address("image/jpeg", bytes);
}

/// Of a region: the box of the stills that it lies in.
std::vector<cv::Mat> thumbs_of(const Region& region, const std::vector<cv::Mat>& small) {
  cv::Rect box = cv::boundingRect(region.mask);
  if (box.empty()) box = cv::Rect({}, region.mask.size());
  std::vector<cv::Mat> cropped;
  for (const cv::Mat& still : small) cropped.push_back(still(box));
  return reduced(cropped, kThumb);
}

std::string names_list(const std::vector<int>& stills, const std::vector<std::string>& names) {
  std::string list;
  for (const int still : stills) {
    std::string quoted;
    for (const char c : names[still])
      quoted += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", quoted);
  }
  return "[" + list + "]";
}

class RegionPart {
 public:
  RegionPart(const PlannedRegion& region, std::size_t number, const std::vector<cv::Mat>& small,
             const PageFacts& facts)
      : region_(region), number_(number), facts_(facts), thumbs_(thumbs_of(region.region, small)) {}

  std::string html() const {
    std::string out =
        fmt::format("<section><h2>Region {} <small>({}{})</small></h2>\n", html_text(region_.region.name),
                    to_string(region_.region.kind),
                    region_.reference.empty() ? "" : ", goes by " + html_text(region_.reference));
    out += symbols() + graph() + paths() + sequence();
    return out + "</section>\n";
  }

 private:
  std::string symbols() const {
    std::string out = "<svg width=\"0\" height=\"0\" style=\"position:absolute\"><defs>\n";
    for (std::size_t i = 0; i < thumbs_.size(); ++i)
      out += fmt::format("<image id=\"s{}-{}\" width=\"{}\" height=\"{}\" href=\"{}\"/>\n", number_, i,
                         thumbs_[i].cols, thumbs_[i].rows, picture_address(thumbs_[i]));
    return out + "</defs></svg>\n";
  }

  std::string shown(int still, double x, double y, double scale = 1) const {
    return fmt::format("<use href=\"#s{}-{}\" transform=\"translate({:.1f} {:.1f}) scale({:.2f})\"/>",
                       number_, still, x, y, scale);
  }

  std::string graph() const {
    const std::vector<cv::Point2d> at = laid_out(region_.rms);
    const auto px = [&](int i) { return kWidth * .5 + at[i].x * (kWidth * .5 - kThumb); };
    const auto py = [&](int i) { return kHeight * .5 + at[i].y * (kHeight * .5 - kThumb); };
    std::string out = fmt::format(
        "<svg class=\"graph\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Graph\">\n", kWidth, kHeight);
    const StillGraph& graph = region_.graph;
    for (int i = 0; i < graph.count(); ++i)
      for (int j = 0; j < i; ++j)
        if (graph.edge(i, j) != 0)
          out += fmt::format(
              "<line x1=\"{:.0f}\" y1=\"{:.0f}\" x2=\"{:.0f}\" y2=\"{:.0f}\" class=\"edge\" "
              "opacity=\"{:.2f}\"/>\n",
              px(i), py(i), px(j), py(j),
              std::clamp(.5 * graph.mean_edge_weight / std::max(graph.weight(i, j), 1e-9), .04, .5));
    const std::vector<Path> paths = one_way(region_.paths);
    for (std::size_t k = 0; k < paths.size(); ++k) {
      std::string points;
      const double aside = 2.5 * static_cast<double>(k % 5) - 5;  // so that paths do not hide each other
      for (const int still : paths[k])
        points += fmt::format("{:.0f},{:.0f} ", px(still) + aside, py(still) + aside);
      out += fmt::format("<polyline points=\"{}\" class=\"path\" stroke=\"{}\"/>\n", points,
                         kColours[k % std::size(kColours)]);
    }
    for (int i = 0; i < graph.count(); ++i) {
      const double scale = .55, w = thumbs_[i].cols * scale, h = thumbs_[i].rows * scale;
      out += fmt::format("<g><title>{}</title>{}<text x=\"{:.0f}\" y=\"{:.0f}\">{}</text></g>\n",
                         html_text(facts_.names[i]), shown(i, px(i) - w / 2, py(i) - h / 2, scale),
                         px(i) - w / 2, py(i) + h / 2 + 11, html_text(stem(i)));
    }
    return out + "</svg>\n";
  }

  std::string strip(const std::vector<int>& stills, const std::vector<std::string>& words) const {
    constexpr int kLetter = 6;  // px, about the mean width of one
    std::size_t longest = 0;
    for (const std::string& word : words) longest = std::max(longest, word.size());
    const int step_x = std::max(thumbs_[0].cols + 4, kLetter * static_cast<int>(longest));
    const int height = thumbs_[0].rows + 16;
    std::string out = fmt::format("<div class=\"strip\"><svg width=\"{}\" height=\"{}\">\n",
                                  step_x * static_cast<int>(stills.size()), height);
    for (std::size_t k = 0; k < stills.size(); ++k)
      out += shown(stills[k], static_cast<double>(k) * step_x, 0) +
             fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", k * step_x, height - 4, html_text(words[k]));
    return out + "</svg></div>\n";
  }

  std::string paths() const {
    std::string out = "<h3>Paths</h3>\n";
    const std::vector<Path> paths = one_way(region_.paths);
    for (std::size_t k = 0; k < paths.size(); ++k) {
      std::vector<std::string> words;
      for (const int still : paths[k]) words.push_back(stem(still));
      const bool both =
          std::find(region_.paths.begin(), region_.paths.end(), reversed(paths[k])) != region_.paths.end();
      const std::vector<int> ends{paths[k].front(), paths[k].back()}, back{paths[k].back(), paths[k].front()};
      out += fmt::format(
          "<p><b style=\"color:{}\">{}</b> {} <code>refuse = [{}]</code> <code>turn = [{}]</code></p>\n",
          kColours[k % std::size(kColours)], k + 1, both ? "both ways." : "this way only.",
          html_text(names_list(ends, facts_.names)), html_text(names_list(back, facts_.names)));
      out += strip(paths[k], words);
    }
    return out;
  }

  std::string sequence() const {
    std::vector<int> stills;
    std::vector<std::string> words;
    for (std::size_t k = 0; k < region_.sequence.size(); ++k) {
      if (region_.timeline.times()[k] > facts_.seconds) break;
      stills.push_back(region_.sequence[k]);
      words.push_back(fmt::format("{:.2f} s  {}", region_.timeline.times()[k], stem(region_.sequence[k])));
    }
    return "<h3>Sequence</h3>\n" + strip(stills, words);
  }

  std::string stem(int still) const {
    const std::string& name = facts_.names[still];
    return name.substr(0, name.rfind('.'));
  }

  const PlannedRegion& region_;
  std::size_t number_;
  const PageFacts& facts_;
  std::vector<cv::Mat> thumbs_;
};

// clang-format off
constexpr std::string_view kTemplate =
#include "embedded/stills_page.html"
    ;
// clang-format on

}  // namespace

std::vector<Path> one_way(const std::vector<Path>& paths) {
  std::vector<Path> kept;
  for (const Path& path : paths)
    if (std::find(kept.begin(), kept.end(), reversed(path)) == kept.end()) kept.push_back(path);
  return kept;
}

std::vector<cv::Point2d> laid_out(const Square<double>& distances) {
  const int n = distances.n;
  // Torgerson's scaling: squared distances, centred both ways, and their two strongest directions.
  cv::Mat centred(n, n, CV_64F), values, vectors;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) centred.at<double>(i, j) = -.5 * distances(i, j) * distances(i, j);
  cv::Mat rows, columns;
  cv::reduce(centred, columns, 0, cv::REDUCE_AVG);
  cv::reduce(centred, rows, 1, cv::REDUCE_AVG);
  centred = centred - cv::repeat(columns, n, 1) - cv::repeat(rows, 1, n) + cv::mean(centred)[0];
  cv::eigen(centred, values, vectors);
  std::vector<cv::Point2d> places(static_cast<std::size_t>(n));
  double most = 1e-9;
  for (int i = 0; i < n; ++i) {
    places[i].x = vectors.at<double>(0, i) * std::sqrt(std::max(0.0, values.at<double>(0)));
    if (n > 1) places[i].y = vectors.at<double>(1, i) * std::sqrt(std::max(0.0, values.at<double>(1)));
    most = std::max({most, std::abs(places[i].x), std::abs(places[i].y)});
  }
  for (cv::Point2d& each : places) each *= 1 / most;
  return places;
}

std::string stills_page(const Plan& plan, const std::vector<cv::Mat>& small, const cv::Mat& sheet,
                        const PageFacts& facts) {
  std::string out;
  for (const std::string& notice : facts.notices) out += "<p>" + html_text(notice) + "</p>\n";
  if (!facts.video.empty())
    out +=
        fmt::format("<video src=\"{}\" controls loop muted playsinline></video>\n", html_text(facts.video));
  if (!sheet.empty()) out += fmt::format("<p><img alt=\"Regions\" src=\"{}\"></p>\n", picture_address(sheet));
  for (std::size_t i = 0; i < plan.regions.size(); ++i)
    out += RegionPart(plan.regions[i], i, plan.regions[i].front ? plan.regions[i].front->small : small, facts)
               .html();
  return report::page_html(
      facts.title,
      report::filled(kTemplate, {{"counts", fmt::format("{} stills, {} moving regions, {:.2f} s",
                                                        small.size(), plan.regions.size(), facts.seconds)},
                                 {"rest", out}}));
}

}  // namespace freshet::synth::stills
