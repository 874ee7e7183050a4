#include "tools/sweep_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "query/labelling/assignment.h"
#include "report/html_text.h"

namespace freshet::tools {
namespace {

using report::html_text;

constexpr int kCell = 480, kCaption = 40, kGap = 8;  // px
const cv::Scalar kPaper(32, 32, 32), kInk(225, 225, 225), kFaint(165, 165, 165);

// Smaller when it would not fit, and cut when even that does not.
void caption(cv::Mat& sheet, std::string text, cv::Point at, int width, const cv::Scalar& colour) {
  const auto width_of = [&](double size) {
    int baseline = 0;
    return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline).width;
  };
  double size = 0.45;
  if (width_of(size) > width) size = 0.36;
  while (text.size() > 3 && width_of(size) > width) text.replace(text.size() - 3, 3, "..").pop_back();
  cv::putText(sheet, text, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

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

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ font: 16px/1.45 sans-serif; background: #fff; color: #1a1a1a; margin: 1rem; }}
h1 {{ font-size: 1.25rem; margin: 0 0 .5rem; }}
button {{ font: inherit; padding: .2rem .7rem; margin-right: .3rem; }}
main {{ display: grid; gap: 1rem; margin: 1rem 0; grid-template-columns: repeat(auto-fill, minmax(min(100%, {column}px), 1fr)); }}
figure {{ margin: 0; }} video, img {{ width: 100%; height: auto; display: block; background: #ddd; }}
figcaption b {{ display: block; }}
table {{ border-collapse: collapse; }} th, td {{ text-align: left; padding: .15rem .8rem .15rem 0; border-bottom: 1px solid #ccc; }}
td.n {{ text-align: right; font-variant-numeric: tabular-nums; }}
@media (prefers-color-scheme: dark) {{ body {{ background: #17191c; color: #e6e6e6; }} a {{ color: #8cbfff; }} th, td {{ border-color: #444; }} }}
</style>
<h1>{title}</h1>
<p>
<button type="button" id="play">Play all</button><button type="button" id="pause">Pause all</button><button type="button" id="again">From the start, together</button>
</p>
<main>
<figure><img src="{still}" width="{width}" height="{height}" alt="The still picture"><figcaption><b>still</b></figcaption></figure>
)";

// Without scripts each video still has its own controls.
constexpr const char* kScript = R"(<script>
const videos = [...document.querySelectorAll('video')];
const play = () => videos.forEach(v => v.play().catch(() => {}));
document.getElementById('play').onclick = play;
document.getElementById('pause').onclick = () => videos.forEach(v => v.pause());
document.getElementById('again').onclick = () => { videos.forEach(v => { v.currentTime = 0; }); play(); };
if (!matchMedia('(prefers-reduced-motion: reduce)').matches) play();
</script>
</html>
)";

}  // namespace

std::string energy_text(const SweptAnimation& animation) {
  std::string text = fmt::format("energy {:.2f}", animation.energy);
  if (std::isfinite(animation.gap)) text += fmt::format(", gap {:.2f}%", 100 * animation.gap);
  if (std::isfinite(animation.gap) && animation.gap > query::kGapAimed)
    text += fmt::format(", above {}%", 100 * query::kGapAimed);
  return text;
}

cv::Mat sweep_sheet(const cv::Mat& still, const std::vector<SweptAnimation>& animations) {
  const double scale = std::min({1.0, 1.0 * kCell / still.cols, 1.0 * kCell / still.rows});
  const cv::Size picture(std::max(1, cvRound(still.cols * scale)), std::max(1, cvRound(still.rows * scale)));
  const cv::Size cell(std::max(picture.width, 200) + kGap, picture.height + kCaption + kGap);
  const int count = static_cast<int>(animations.size()) + 1;
  const int columns = std::clamp(cvCeil(std::sqrt(1.0 * count * cell.height / cell.width)), 1, count);
  const int rows = (count + columns - 1) / columns;
  cv::Mat sheet(rows * cell.height + kGap, columns * cell.width + kGap, CV_8UC3, kPaper);
  for (int i = 0; i < count; ++i) {
    const cv::Point corner(i % columns * cell.width + kGap, i / columns * cell.height + kGap);
    const cv::Mat& shown = i == 0 ? still : animations[i - 1].frame;
    cv::Mat place = sheet(cv::Rect(corner, picture));
    cv::resize(shown, place, picture, 0, 0, cv::INTER_AREA);
    const int below = corner.y + picture.height, width = cell.width - kGap;
    caption(sheet, i == 0 ? "still" : animations[i - 1].title, {corner.x, below + 16}, width, kInk);
    if (i > 0) caption(sheet, energy_text(animations[i - 1]), {corner.x, below + 33}, width, kFaint);
  }
  return sheet;
}

std::string sweep_page(const std::string& title, const std::string& still, cv::Size size,
                       const std::vector<SweptAnimation>& animations) {
  const int column = std::clamp(size.width, 200, 460);
  std::string page = fmt::format(kHead, fmt::arg("title", html_text(title)), fmt::arg("column", column),
                                 fmt::arg("still", address_of(still)), fmt::arg("width", size.width),
                                 fmt::arg("height", size.height));
  for (const SweptAnimation& animation : animations) {
    const std::string name = html_text(animation.title), at = address_of(animation.video);
    const std::string element =
        animation.video.ends_with(".webp")
            ? fmt::format(R"(<img src="{}" width="{}" height="{}" alt="Animation with {}">)", at, size.width,
                          size.height, name)
            : fmt::format(R"(<video src="{}" width="{}" height="{}" controls loop muted playsinline )"
                          R"(preload="auto" aria-label="Animation with {}"></video>)",
                          at, size.width, size.height, name);
    page += fmt::format("<figure>{}<figcaption><b>{}</b>{}</figcaption></figure>\n", element, name,
                        energy_text(animation));
  }
  page +=
      "</main>\n<table>\n<thead><tr><th scope=\"col\">settings</th><th scope=\"col\">energy</th>"
      "<th scope=\"col\">gap</th><th scope=\"col\">pieces unlike the first's</th>"
      "<th scope=\"col\">files</th></tr></thead>\n<tbody>\n";
  for (const SweptAnimation& animation : animations)
    page += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{:.3f}</td><td class=\"n\">{}</td><td class=\"n\">"
        "{:.0f}%</td><td><a href=\"{}\">video</a> <a href=\"{}\">assignment</a></td></tr>\n",
        html_text(animation.title), animation.energy,
        std::isfinite(animation.gap) ? fmt::format("{:.2f}%", 100 * animation.gap) : "-",
        100 * animation.changed, address_of(animation.video), address_of(animation.assignment));
  return page + "</tbody>\n</table>\n" + kScript;
}

}  // namespace freshet::tools
