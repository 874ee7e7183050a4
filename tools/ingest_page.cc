#include "tools/ingest_page.h"

#include <fmt/format.h>

#include "report/data_address.h"
#include "report/html_text.h"
#include "report/page.h"

namespace freshet::tools {
namespace {

using report::html_text;

// clang-format off
constexpr std::string_view kTemplate =
#include "embedded/ingest_page.html"
    ;
// clang-format on

bool taken(const ingest::ClipReport& clip) {
  return clip.outcome == ingest::Outcome::kAdded || clip.outcome == ingest::Outcome::kWouldAdd;
}

double length_s(const ingest::ClipReport& clip) { return clip.fps > 0 ? clip.frames / clip.fps : 0; }

std::string line(const std::string& text, const char* kind = "") {
  return fmt::format("<p{}>{}</p>", kind, html_text(text));
}

std::string card(const ingest::ClipReport& clip) {
  const bool there = clip.outcome == ingest::Outcome::kAlreadyThere;
  std::string out = fmt::format("<div class=\"clip{}\">", taken(clip) ? " taken" : there ? "" : " left");
  if (!clip.look.jpeg.empty())
    out += fmt::format("<img src=\"{}\" alt=\"\">", report::data_address("image/jpeg", clip.look.jpeg));
  if (clip.part) out += line(fmt::format("{:.2f} to {:.2f} s", clip.part->from_s, clip.part->to_s));
  out += fmt::format("<p><b>{}</b></p>", ingest::to_string(clip.outcome));
  std::string facts = clip.class_name.empty() ? "" : "class " + clip.class_name;
  if (const std::string kind = kind_text(clip.look); !kind.empty())
    facts += fmt::format("{}looks like {}", facts.empty() ? "" : ", ", kind);
  if (clip.frames > 0 && clip.width > 0)
    facts += fmt::format("{}{:.1f} s, {} x {} px, {:.2f} frames/s", facts.empty() ? "" : "; ", length_s(clip),
                         clip.width, clip.height, clip.fps);
  out += line(facts, " class=\"faint\"");
  for (const std::string& reason : clip.reasons) out += line(reason);
  for (const std::string& note : clip.notes) out += line(note, " class=\"faint\"");
  for (const std::string& help : clip.help) out += line(help + ".", " class=\"help\"");
  return out + "</div>\n";
}

}  // namespace

std::string kind_text(const ingest::PartLook& look) {
  if (!look.kind) return "";
  return std::string(look.kind->name()) + (look.kind->sure() ? "" : "?");
}

std::string taken_text(const ingest::IngestReport& report) {
  double taken_s = 0, of_s = 0;
  std::size_t clips = 0;
  for (const ingest::ClipReport& clip : report.clips) {
    of_s += length_s(clip);
    if (!taken(clip)) continue;
    taken_s += length_s(clip);
    ++clips;
  }
  const bool preview = report.count(ingest::Outcome::kWouldAdd) > 0;
  return fmt::format("{:.1f} s of {:.1f} s {}, as {} clip{}", taken_s, of_s,
                     preview ? "would be taken" : "taken", clips, clips == 1 ? "" : "s");
}

std::string ingest_page(const std::string& store, const ingest::IngestReport& report) {
  std::string films;
  const std::filesystem::path* film = nullptr;
  for (const ingest::ClipReport& clip : report.clips) {
    if (film == nullptr || *film != clip.path) {
      if (film != nullptr) films += "</div>\n";
      // A part's name is its film's, and where it lies in it.
      const std::string name = clip.part ? clip.name.substr(0, clip.name.rfind('@')) : clip.name;
      films += fmt::format("<h2 class=\"film\">{}</h2>\n<div class=\"clips\">\n", html_text(name));
      film = &clip.path;
    }
    films += card(clip);
  }
  if (film != nullptr) films += "</div>\n";
  std::string counts = taken_text(report) + ".";
  if (report.stopped) counts += fmt::format(" Stopped: {}.", report.stopped->what());
  return report::page_html("Clips for " + store,
                           report::filled(kTemplate, {{"counts", html_text(counts)}, {"films", films}}));
}

}  // namespace freshet::tools
