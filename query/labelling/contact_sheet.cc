#include "query/labelling/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "query/search/picture_scale.h"
#include "report/sheet_words.h"
#include "stored/middle_frame.h"
#include "stored/store_settings.h"
#include "vision/settings.h"

namespace freshet::query {
namespace {

constexpr int kMargin = 6, kCaption = 14;  // px
constexpr int kEnlarged = 2;               // times: 48 px are hard to judge
const cv::Scalar kChosen(90, 220, 90);

void caption(cv::Mat& sheet, const std::string& text, cv::Point at) {
  cv::putText(sheet, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.32, cv::Scalar::all(report::kSheetInk), 1,
              cv::LINE_AA);
}

cv::Mat enlarged(const cv::Mat& part) {
  cv::Mat large;
  cv::resize(part, large, {}, kEnlarged, kEnlarged, cv::INTER_CUBIC);
  return large;
}

}  // namespace

cv::Mat contact_sheet(const store::Snapshot& snapshot, const cv::Mat& picture, const CandidateSearch& search,
                      const Labels* labels, const ContactSheetOptions& options) {
  const std::vector<vision::Variant> variants = stored::settings_of(snapshot).variants();
  const Target& target = search.target;
  const auto pieces = static_cast<int>(target.size());
  const int shown = std::max(1, std::min(options.pieces, pieces)), across = std::max(1, options.candidates);
  const int tile = kEnlarged * target.side, width = tile + kMargin, height = tile + kMargin + kCaption;
  const int columns = 1 + across + (labels != nullptr ? 1 : 0);
  cv::Mat sheet(kMargin + shown * height, kMargin + columns * width, CV_8UC3,
                cv::Scalar::all(report::kSheetPaper));

  // What is to be shown where, gathered by clip and variant, so that each image is read and turned once.
  struct Spot {
    stored::Row row;
    cv::Point at;
  };
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::vector<Spot>> spots;
  cv::Mat beyond;
  const int border = target.side;
  cv::copyMakeBorder(reduce(picture, search.piece_scale), beyond, border, border, border, border,
                     cv::BORDER_REFLECT_101);
  for (int i = 0; i < shown && pieces > 0; ++i) {
    const auto piece = static_cast<std::size_t>(static_cast<std::int64_t>(i) * pieces / shown);
    const cv::Point at(kMargin, kMargin + i * height);
    const cv::Size side(target.side, target.side), shown_side = side * kEnlarged;
    enlarged(beyond(cv::Rect(target.corners[piece] + cv::Point(border, border), side)))
        .copyTo(sheet(cv::Rect(at, shown_side)));
    caption(sheet, fmt::format("{},{}", target.corners[piece].x, target.corners[piece].y),
            at + cv::Point(0, tile + 11));
    const auto rows = search.candidates.rows_of(piece);
    const auto scores = search.candidates.scores_of(piece);
    const auto put = [&](std::size_t rank, int column) {
      const cv::Point spot = at + cv::Point(column * width, 0);
      const stored::Row row = rows[rank];
      spots[{search.table().clip[row], search.table().variant[row]}].push_back({row, spot});
      caption(sheet,
              fmt::format("{:.0f} #{}", 100 * scores[rank],
                          static_cast<std::uint32_t>(search.table().clips[search.table().clip[row]])),
              spot + cv::Point(0, tile + 11));
      return spot;
    };
    for (int rank = 0; rank < std::min<int>(across, static_cast<int>(rows.size())); ++rank) {
      put(static_cast<std::size_t>(rank), 1 + rank);
    }
    if (labels != nullptr) {
      const cv::Point spot = put((*labels)[piece], 1 + across);
      cv::rectangle(sheet, cv::Rect(spot - cv::Point(2, 2), shown_side + cv::Size(4, 4)), kChosen, 2);
    }
  }
  std::uint32_t clip_at_hand = 0xffffffff;
  cv::Mat whole;
  for (const auto& [key, places] : spots) {
    if (key.first != clip_at_hand)
      whole = stored::middle_frame(snapshot, search.table().clips[clip_at_hand = key.first]);
    const cv::Mat frame = vision::warp_to_variant(whole, variants[key.second]);
    for (const Spot& spot : places) {
      const cv::Rect patch(search.table().x[spot.row], search.table().y[spot.row], target.side, target.side);
      enlarged(frame(patch)).copyTo(sheet(cv::Rect(spot.at, patch.size() * kEnlarged)));
    }
  }
  std::vector<std::string> legend{fmt::format(
      "{} of {} pieces, a row each: the piece of the picture with its corner's x, y in px{}; then its "
      "best candidates, each as the frame in the middle of its clip shows it, with its likeness in per cent "
      "(of averages over time, without colour) and its clip's number. All {} times as large.",
      shown, pieces,
      search.piece_scale != 1 ? fmt::format(" (of the picture reduced by {:g})", search.piece_scale) : "",
      kEnlarged)};
  if (labels != nullptr) legend.emplace_back("Right, framed in green: the one that was chosen.");
  std::map<std::uint32_t, std::string> names;  // by number, of the clips that are shown
  for (const auto& [key, places] : spots) {
    const store::ClipId clip = search.table().clips[key.first];
    names[static_cast<std::uint32_t>(clip)] = snapshot.clip(clip).name;
  }
  std::string clips;
  for (const auto& [number, name] : names)
    clips += fmt::format("{}#{} {}", clips.empty() ? "" : ", ", number, name);
  legend.push_back(clips + ".");
  return report::with_legend(sheet, legend);
}

}  // namespace freshet::query
