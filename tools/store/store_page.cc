#include "tools/store/store_page.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/data_address.h"
#include "report/html_text.h"
#include "report/page.h"
#include "tools/console/table.h"

namespace freshet::tools {
namespace {

using report::html_text;

// clang-format off
constexpr std::string_view kTemplate =
#include "embedded/store_page.html"
    ;
// clang-format on

constexpr const char* kPaces[] = {"slow", "natural", "fast"};
/// Of ShownClip::speed, quartiles of 35 real clips by kind; those drawn by lot (docs/measurements/measures.md) are not
/// among them. What the critic reads in a film (judging::usual_speed) is another measure, some three times as large.
struct UsualSpeed {
  std::string_view kind;
  double slow, fast;
};
constexpr UsualSpeed kUsual[] = {
    {"water", .016, .060}, {"fire", .035, .207}, {"smoke", .019, .052}, {"clouds", .010, .079}};
constexpr double kMuch = 0.25;  // of a picture's pieces that are unlike: it lacks clips

bool is_kind(const std::string& name) {
  return std::ranges::find(kUsual, name, &UsualSpeed::kind) != std::end(kUsual);
}

std::size_t count(const StoreContents& contents, const std::string& kind, const std::string& pace = {}) {
  return static_cast<std::size_t>(std::ranges::count_if(contents.clips, [&](const ShownClip& clip) {
    return clip.class_name == kind && (pace.empty() || pace_of(clip) == pace);
  }));
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

std::string kinds_table(const StoreContents& contents) {
  struct Sum {
    std::size_t clips = 0;
    double seconds = 0, darkest = 1, lightest = 0;
    std::uint64_t patches = 0;
  };
  std::map<std::string, Sum> kinds;
  for (const UsualSpeed& usual : kUsual) kinds[std::string(usual.kind)];
  for (const ShownClip& clip : contents.clips) {
    Sum& sum = kinds[clip.class_name];
    ++sum.clips;
    sum.seconds += clip.seconds;
    sum.patches += clip.patches;
    sum.darkest = std::min(sum.darkest, clip.light);
    sum.lightest = std::max(sum.lightest, clip.light);
  }
  report::HtmlTable table({"kind", "clips", "seconds", "patches", "slow", "natural", "fast", "light"});
  for (const auto& [kind, sum] : kinds) {
    std::vector<std::string> cells{html_text(kind), fmt::format("{}", sum.clips),
                                   fmt::format("{:.0f}", sum.seconds), fmt::format("{}", sum.patches)};
    for (const char* pace : kPaces)
      cells.push_back(is_kind(kind) ? fmt::format("{}", count(contents, kind, pace)) : "");
    cells.push_back(sum.clips > 0 ? percent(sum.darkest) + " to " + percent(sum.lightest) : "");
    table.add(cells);
  }
  return table.html();
}

std::string strip_html(const PlayedStrip& strip) {
  if (strip.jpeg.empty()) return "";
  return fmt::format(
      "<div class=\"strip\" role=\"img\" style=\"width:{0}px;height:{1}px;--frames:{2};--end:-{3}px;"
      "animation-duration:{4:.2f}s;background-image:url({5})\"></div>",
      strip.frame.width, strip.frame.height, strip.frames, strip.frame.width * strip.frames, strip.seconds,
      report::data_address("image/jpeg", strip.jpeg));
}

/// Whose it is, what may be done with it, and where it came from.
std::string owed(const ShownClip& clip) {
  std::string text = clip.author.empty() ? "" : html_text(clip.author) + "; ";
  text += clip.licence.empty() ? "no licence is said" : html_text(clip.licence);
  return text + (clip.source.empty() ? "" : "; " + html_text(clip.source));
}

std::string card(const ShownClip& clip) {
  std::string facts = fmt::format("{} x {} px, {:.2f} frames/s, {:.1f} s; {} patches", clip.size.width,
                                  clip.size.height, clip.fps, clip.seconds, clip.patches);
  const std::string pace = pace_of(clip);
  facts += fmt::format("; {:.2f} sides/s{}; light {}", clip.speed, pace.empty() ? "" : ", " + pace,
                       percent(clip.light));
  if (clip.half_life_s > 0)
    facts += fmt::format("; half of its detail is new after {:.2g} s", clip.half_life_s);
  if (clip.alike >= 0) facts += fmt::format("; {} like the other clips", percent(clip.alike));
  return fmt::format("<div class=\"clip\">{}<p><b>{}</b></p><p class=\"faint\">{}</p><p>{}</p></div>\n",
                     strip_html(clip.strip), html_text(clip.name), facts, owed(clip));
}

std::string asked(const AskedPicture& picture) {
  return fmt::format(
      "<div class=\"asked\"><h3>{}</h3><img src=\"{}\" alt=\"\"><p>{} of its pieces look like nothing in the "
      "store (red); at half the size {}. It looks like {}{}.</p></div>\n",
      html_text(picture.name), report::data_address("image/jpeg", picture.jpeg), percent(picture.unlike),
      percent(picture.unlike_reduced), html_text(picture.kind), picture.kind_sure ? "" : ", maybe");
}

}  // namespace

std::string pace_of(const ShownClip& clip) {
  const auto* const usual = std::ranges::find(kUsual, clip.class_name, &UsualSpeed::kind);
  if (usual == std::end(kUsual)) return "";
  return kPaces[clip.speed < usual->slow ? 0 : clip.speed <= usual->fast ? 1 : 2];
}

std::vector<std::string> lacks_of(const StoreContents& contents) {
  std::vector<std::string> lacks;
  for (const UsualSpeed& usual : kUsual) {
    const std::string kind(usual.kind);
    if (count(contents, kind) == 0) {
      lacks.push_back(fmt::format("No {}.", kind));
      continue;
    }
    for (const char* pace : kPaces)
      if (count(contents, kind, pace) == 0)
        lacks.push_back(pace == kPaces[1] ? fmt::format("No {} of its usual speed.", kind)
                                          : fmt::format("No {} {}.", pace, kind));
  }
  for (const AskedPicture& picture : contents.pictures) {
    if (picture.unlike < kMuch) continue;
    lacks.push_back(fmt::format("{}, as {} shows it: {} of its pieces look like nothing here{}.",
                                picture.kind, picture.name, percent(picture.unlike),
                                picture.unlike_reduced < picture.unlike / 2
                                    ? ", at half the size half as many: film it from nearer"
                                    : ""));
  }
  return lacks;
}

std::string store_page(const StoreContents& contents) {
  double seconds = 0;
  std::uint64_t patches = 0;
  std::map<std::string, std::string> classes;
  for (const ShownClip& clip : contents.clips) {
    seconds += clip.seconds;
    patches += clip.patches;
    classes[clip.class_name] += card(clip);
  }
  std::string lacks, shown, pictures;
  for (const std::string& each : lacks_of(contents)) lacks += "<li>" + html_text(each) + "</li>\n";
  for (const auto& [name, cards] : classes)
    shown += fmt::format("<h2>{}</h2>\n<div class=\"clips\">{}</div>\n", html_text(name), cards);
  for (const AskedPicture& picture : contents.pictures) pictures += asked(picture);
  return report::page_html(
      contents.store,
      report::filled(
          kTemplate,
          {{"counts", fmt::format("{} clips, {:.0f} s, {} patches, {}.", contents.clips.size(), seconds,
                                  patches, bytes_text(static_cast<double>(contents.bytes)))},
           {"lacks", lacks.empty() ? "<p>Nothing that this page can tell.</p>" : "<ul>" + lacks + "</ul>"},
           {"kinds", kinds_table(contents)},
           {"pictures", pictures.empty() ? "" : "<h2>What pictures ask</h2>\n" + pictures},
           {"classes", shown}}));
}

nlohmann::json to_json(const StoreContents& contents) {
  nlohmann::json clips = nlohmann::json::array(), pictures = nlohmann::json::array();
  for (const ShownClip& clip : contents.clips)
    clips.push_back({{"name", clip.name},
                     {"class", clip.class_name},
                     {"licence", clip.licence},
                     {"author", clip.author},
                     {"source", clip.source},
                     {"seconds", clip.seconds},
                     {"patches", clip.patches},
                     {"sides_per_second", clip.speed},
                     {"pace", pace_of(clip)},
                     {"light", clip.light},
                     {"half_life_s", clip.half_life_s},
                     {"alike", clip.alike < 0 ? nlohmann::json() : nlohmann::json(clip.alike)}});
  for (const AskedPicture& picture : contents.pictures)
    pictures.push_back({{"name", picture.name},
                        {"kind", picture.kind},
                        {"kind_sure", picture.kind_sure},
                        {"unlike", picture.unlike},
                        {"unlike_at_half_size", picture.unlike_reduced}});
  return {{"store", contents.store},
          {"bytes", contents.bytes},
          {"clips", clips},
          {"pictures", pictures},
          {"lacks", lacks_of(contents)}};
}

}  // namespace freshet::tools
