#include "tools/synth/sweep_page.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "report/html_text.h"
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

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ font: 16px/1.45 sans-serif; background: #fff; color: #1a1a1a; margin: 1rem; }}
h1 {{ font-size: 1.25rem; margin: 0 0 .5rem; }} ul {{ margin: .3rem 0 .6rem; padding-left: 1.2rem; }}
nav {{ position: sticky; top: 0; background: inherit; padding: .4rem 0; z-index: 1; display: flex; flex-wrap: wrap; gap: .4rem; align-items: center; }}
button {{ font: inherit; padding: .2rem .7rem; }} #scrub {{ flex: 1 1 12rem; }} output {{ font-variant-numeric: tabular-nums; min-width: 9rem; }}
main {{ display: grid; gap: 1rem; margin: 1rem 0; grid-template-columns: repeat(auto-fill, minmax(min(100%, {column}px), 1fr)); }}
figure {{ margin: 0; }} figcaption b {{ display: block; }}
.view {{ position: relative; overflow: hidden; aspect-ratio: {crop_width} / {crop_height}; background: #ddd; }}
.view > * {{ position: absolute; display: block; width: {view_width}%; left: {view_left}%; top: {view_top}%; height: auto; }}
.whole .view {{ aspect-ratio: {width} / {height}; }} .whole .view > * {{ width: 100%; left: 0; top: 0; }}
.rows {{ overflow-x: auto; }} table {{ border-collapse: collapse; min-width: 56rem; }}
th, td {{ text-align: left; vertical-align: top; padding: .15rem .8rem .15rem 0; border-bottom: 1px solid #ccc; }}
li, figcaption, td:nth-child(2), td:nth-child(3) {{ overflow-wrap: anywhere; }} td:nth-child(2), td:nth-child(3) {{ min-width: 10rem; }} td:last-child {{ min-width: 18rem; }}
td.n {{ text-align: right; font-variant-numeric: tabular-nums; }} code {{ font-size: .8rem; overflow-wrap: anywhere; }}
@media (prefers-color-scheme: dark) {{ body {{ background: #17191c; color: #e6e6e6; }} a {{ color: #8cbfff; }} th, td {{ border-color: #444; }} }}
</style>
<h1>{title}</h1>
<p>What differs from one to the next:</p>
<ul>
{axes}</ul>
<nav>
<button type="button" id="play">Pause</button><button type="button" id="back" title="One frame back">&#8249;</button><button type="button" id="on" title="One frame on">&#8250;</button>
<input type="range" id="scrub" min="0" max="1" step="any" value="0" aria-label="Time">
<output id="time"></output>
<label><input type="checkbox" id="whole"> whole picture</label>
</nav>
<main>
<figure><div class="view"><img src="{still}" alt="The still picture"></div><figcaption><b>the still</b></figcaption></figure>
)";

// One clock for all: videos play by themselves, and whoever strays from it by more than a frame is set right. Those
// that are shorter begin again by themselves.
constexpr const char* kScript = R"(<script>
const fps = {fps}, videos = [...document.querySelectorAll('video')];
const by = id => document.getElementById(id);
let playing = false, begun = 0, at = 0;
const longest = () => Math.max(0.001, ...videos.map(v => v.duration || 0));
const now = () => playing ? (at + (performance.now() - begun) / 1000) % longest() : at;
const set = (v, t) => {{ const to = t % (v.duration || 1); let off = Math.abs(v.currentTime - to); off = Math.min(off, (v.duration || 1) - off); if (off > (playing ? 1.5 / fps : 0.001)) v.currentTime = to; }};
const show = () => {{ const t = now(); videos.forEach(v => set(v, t)); by('scrub').value = t / longest(); by('time').textContent = t.toFixed(2) + ' s, frame ' + Math.floor(t * fps + 0.001); }};
const tick = () => {{ if (!playing) return; show(); requestAnimationFrame(tick); }};
const play = () => {{ playing = true; begun = performance.now(); by('play').textContent = 'Pause'; videos.forEach(v => v.play().catch(() => {{}})); tick(); }};
const pause = t => {{ at = t; playing = false; by('play').textContent = 'Play'; videos.forEach(v => v.pause()); show(); }};
const step = frames => {{ const n = Math.round(longest() * fps); pause(((Math.floor(now() * fps + 0.001) + frames + n) % n + 0.5) / fps); }};
by('play').onclick = () => playing ? pause(now()) : play();
by('back').onclick = () => step(-1);
by('on').onclick = () => step(1);
by('scrub').oninput = e => pause(e.target.value * longest() * 0.9999);
by('whole').onchange = e => document.body.classList.toggle('whole', e.target.checked);
const ready = v => v.readyState > 2 ? Promise.resolve() : new Promise(done => {{ v.oncanplay = v.onerror = done; }});
Promise.all(videos.map(ready)).then(() => matchMedia('(prefers-reduced-motion: reduce)').matches ? pause(0) : play());
</script>
</html>
)";

std::string figure_of(const SweptAnimation& animation) {
  return fmt::format(
      "<figure><div class=\"view\"><video src=\"{}\" loop muted playsinline preload=\"auto\" "
      "aria-label=\"{}\"></video></div><figcaption><b>{} {}</b>{}</figcaption></figure>\n",
      address_of(animation.video), html_text(animation.title), animation.number, html_text(animation.title),
      html_text(animation.result));
}

std::string row_of(const SweptAnimation& animation) {
  const auto link = [](const std::string& file, const char* name) {
    return fmt::format("<a href=\"{}\">{}</a>", address_of(file), name);
  };
  return fmt::format(
      "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td class=\"n\">{:.3f}</td>"
      "<td class=\"n\">{}</td><td>{} {}</td><td><code>{}</code></td></tr>\n",
      animation.number, html_text(animation.title), html_text(animation.result), animation.energy,
      std::isfinite(animation.gap) ? fmt::format("{:.2f}%", 100 * animation.gap) : "-",
      link(animation.file, "animation"), link(animation.assignment, "patches"), html_text(animation.command));
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
  const cv::Rect& crop = words.region;
  std::string page = fmt::format(
      kHead, fmt::arg("title", html_text(words.title)), fmt::arg("column", std::clamp(crop.width, 240, 460)),
      fmt::arg("axes", axes), fmt::arg("still", address_of(words.still)), fmt::arg("width", words.size.width),
      fmt::arg("height", words.size.height), fmt::arg("crop_width", crop.width),
      fmt::arg("crop_height", crop.height),
      fmt::arg("view_width", fmt::format("{:.4f}", 100.0 * words.size.width / crop.width)),
      fmt::arg("view_left", fmt::format("{:.4f}", -100.0 * crop.x / crop.width)),
      fmt::arg("view_top", fmt::format("{:.4f}", -100.0 * crop.y / crop.height)));
  std::string rows;
  for (const SweptAnimation& animation : animations) {
    if (animation.same_as < 0) page += figure_of(animation);
    rows += row_of(animation);
  }
  page +=
      "</main>\n<div class=\"rows\"><table>\n<thead><tr><th scope=\"col\"></th><th "
      "scope=\"col\">settings</th>"
      "<th scope=\"col\">what came out</th><th scope=\"col\">energy</th><th scope=\"col\">gap</th>"
      "<th scope=\"col\">files</th><th scope=\"col\">alone</th></tr></thead>\n<tbody>\n" +
      rows + "</tbody>\n</table></div>\n";
  return page + fmt::format(kScript, fmt::arg("fps", fmt::format("{}", words.fps)));
}

}  // namespace freshet::tools
