#include "synth/flowlines/files/asked_lines.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "synth/flowlines/files/line_files.h"

namespace freshet::synth::flowlines {
namespace {

namespace fs = std::filesystem;

constexpr double kShortestEdited = 4;  // px

template <class Choice, std::size_t N>
Choice parse(const char* option, std::string_view word,
             const std::array<std::pair<std::string_view, Choice>, N>& choices) {
  std::string known;
  for (const auto& [name, choice] : choices) {
    if (name == word) return choice;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw Error(ErrorKind::kUsage, fmt::format("{} \"{}\"", option, word), "there is no such choice",
              "Give one of " + known);
}

void tell(const fs::path& file, const std::vector<std::string>& from, std::vector<std::string>& to) {
  for (const std::string& notice : from) to.push_back(file.string() + ": " + notice);
}

std::vector<FlowLine> lines_of(const fs::path& file, cv::Size picture, double shortest_px,
                               std::vector<std::string>& notices) {
  std::vector<std::string> own;
  std::vector<FlowLine> lines = read_lines(file, picture, shortest_px, &own);
  tell(file, own, notices);
  return lines;
}

}  // namespace

Dynamics parse_dynamics(std::string_view word) {
  return parse<Dynamics, 3>("dynamics", word,
                            {{{"auto", Dynamics::kMeasured},
                              {"stationary", Dynamics::kStationary},
                              {"non-stationary", Dynamics::kNonStationary}}});
}

Mixing parse_mixing(std::string_view word) {
  return parse<Mixing, 3>(
      "blend", word,
      {{{"cut", Mixing::kCut}, {"feather", Mixing::kFeather}, {"contrast", Mixing::kContrast}}});
}

Correspondence parse_correspondence(std::string_view word) {
  return parse<Correspondence, 2>(
      "correspondence", word,
      {{{"equal", Correspondence::kEqual}, {"stretched", Correspondence::kStretched}}});
}

void read_asked(const AskedLines& asked, const Footage& footage, FlowlinesOptions& options,
                std::vector<std::string>& notices) {
  if (!asked.matte.empty()) {
    const media::Matte matte = media::read_matte(asked.matte, footage.size());
    tell(asked.matte, matte.notices, notices);
    options.matte = matte.alpha;
  }
  if (!asked.lines.empty()) {
    const double patch = options.patch_px > 0 ? options.patch_px : default_patch(footage.size());
    options.lines = lines_of(asked.lines, footage.size(), 0.5 * patch, notices);
  }
  if (!asked.edited.empty()) {
    options.edited = lines_of(asked.edited, footage.size(), kShortestEdited, notices);
    options.edited_name = asked.edited.string();
  }
  if (asked.background.empty()) return;
  const media::Picture picture = media::read_picture(asked.background);
  tell(asked.background, picture.notices, notices);
  if (picture.bgr.size() != footage.size())
    throw Error(ErrorKind::kInput, asked.background.string(),
                fmt::format("it has {} x {} px, and the clip {} x {}", picture.bgr.cols, picture.bgr.rows,
                            footage.size().width, footage.size().height),
                "Give a picture of the clip's size");
  options.view.background = picture.bgr;
}

}  // namespace freshet::synth::flowlines
