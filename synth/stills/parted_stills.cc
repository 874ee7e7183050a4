#include "synth/stills/parted_stills.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <system_error>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "synth/outline/background.h"

namespace freshet::synth::stills {
namespace {

constexpr double kFillPx = 4;  // px beside the thing that are filled too, softly: a matte is seldom exact

/// Mean square difference where neither is hidden; huge where nothing is seen in both.
double unlikeness(const cv::Mat& a, const cv::Mat& b, const cv::Mat& hidden) {
  if (cv::countNonZero(hidden) == static_cast<int>(hidden.total())) return 1e300;
  const double norm = cv::norm(a, b, cv::NORM_L2SQR, hidden == 0);
  return norm / (static_cast<double>(hidden.total()) - cv::countNonZero(hidden));
}

/// What is seen in no still is made up from around it.
void make_up(cv::Mat& fill, const cv::Mat& unseen) {
  const double to_bytes = fill.depth() == CV_16U ? 1 / 257.0 : 1;
  cv::Mat bytes;
  fill.convertTo(bytes, CV_8U, to_bytes);
  bytes = outline::inpaint_background(bytes, unseen, {.margin_px = 0});
  bytes.convertTo(bytes, fill.depth(), 1 / to_bytes);
  bytes.copyTo(fill, unseen);
}

template <class T>
void part_one(const cv::Mat& still, const cv::Mat& behind, const cv::Mat& matte, cv::Mat& light,
              cv::Mat& alpha) {
  constexpr float kMost = std::numeric_limits<T>::max();
  for (int y = 0; y < still.rows; ++y)
    for (int x = 0; x < 3 * still.cols; ++x) {
      const float a = static_cast<float>(matte.at<std::uint8_t>(y, x / 3)) / 255;
      const float own =
          static_cast<float>(still.ptr<T>(y)[x]) - (1 - a) * static_cast<float>(behind.ptr<T>(y)[x]);
      light.ptr<T>(y)[x] = a > 0 ? cv::saturate_cast<T>(std::clamp(own, 0.0f, kMost * a)) : T{0};
      alpha.ptr<T>(y)[x] = cv::saturate_cast<T>(kMost * a);
    }
}

}  // namespace

cv::Mat replaced_share(const cv::Mat& matte) {
  cv::Mat away;
  cv::distanceTransform(matte == 0, away, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  const cv::Mat share = 1 - away / (kFillPx + 1);
  return cv::max(share, 0);
}

std::vector<cv::Mat> front_mattes(const std::filesystem::path& folder, const StillSet& set) {
  std::error_code fault;
  if (!std::filesystem::is_directory(folder, fault))
    throw Error(ErrorKind::kInput, folder.string(), fault ? fault.message() : "it is no folder",
                "Give a folder with a grey picture for each still, of the still's name");
  const std::vector<std::filesystem::path> files =
      media::list_folder(folder, media::looks_like_picture).files;
  std::vector<cv::Mat> mattes(set.pictures.size());
  bool any = false;
  for (std::size_t i = 0; i < mattes.size(); ++i) {
    mattes[i] = cv::Mat(set.size(), CV_8U, cv::Scalar(0));
    const auto stem = std::filesystem::path(set.names[i]).stem();
    const auto file =
        std::find_if(files.begin(), files.end(), [&](const auto& each) { return each.stem() == stem; });
    if (file == files.end()) continue;
    const cv::Mat matte = media::read_grey(*file).alpha;
    if (matte.size() != set.file_size)
      throw Error(ErrorKind::kInput, file->string(),
                  fmt::format("it is {} x {} px, the stills are {} x {}", matte.cols, matte.rows,
                              set.file_size.width, set.file_size.height),
                  "Paint it over the still's own file");
    cv::warpPerspective(matte, mattes[i], set.from_file[i], set.size(), cv::INTER_LINEAR);
    media::settle_dark(mattes[i]);
    any |= cv::countNonZero(mattes[i]) > 0;
  }
  if (!any)
    throw Error(ErrorKind::kInput, folder.string(),
                "it has no matte for any of the stills, or black ones alone",
                "Name each matte as its still: " + set.names[0] + " has the matte " +
                    std::filesystem::path(set.names[0]).stem().string() + ".png");
  return mattes;
}

FrontThing part_stills(std::vector<cv::Mat>& pictures, const std::vector<cv::Mat>& mattes,
                       const std::vector<cv::Mat>& farther, const std::string& name,
                       std::vector<std::string>& notices) {
  const std::size_t count = pictures.size();
  std::vector<cv::Mat> small = reduced(pictures, 200), share(count), hidden(count), useless(count),
                       small_hidden(count);
  for (std::size_t i = 0; i < count; ++i) {
    share[i] = replaced_share(mattes[i]);
    hidden[i] = share[i] > 0;
    useless[i] = farther.empty() ? hidden[i] : hidden[i] | (replaced_share(farther[i]) > 0);
    cv::resize(hidden[i], small_hidden[i], small[i].size(), 0, 0, cv::INTER_AREA);
  }
  std::vector<cv::Mat> behind(count);
  std::vector<double> unseen(count, 0);
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    std::vector<double> unlike(count);
    for (std::size_t j = 0; j < count; ++j)
      unlike[j] = unlikeness(small[i], small[j], small_hidden[i] | small_hidden[j]);
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return unlike[a] < unlike[b]; });
    cv::Mat fill = pictures[i].clone(), left = hidden[i].clone();
    for (const std::size_t j : order) {
      if (j == i) continue;
      const cv::Mat shown = left & (useless[j] == 0);
      pictures[j].copyTo(fill, shown);
      left.setTo(0, shown);
    }
    unseen[i] = static_cast<double>(cv::countNonZero(left)) / std::max(1, cv::countNonZero(hidden[i]));
    if (unseen[i] > 0) make_up(fill, left);
    cv::Mat mixed, share3, one, other;
    cv::merge(std::vector<cv::Mat>(3, share[i]), share3);
    pictures[i].convertTo(one, CV_32F);
    fill.convertTo(other, CV_32F);
    mixed = one + (other - one).mul(share3);
    mixed.convertTo(behind[i], pictures[i].depth());
  });
  const double most = *std::max_element(unseen.begin(), unseen.end());
  if (most > .001)
    notices.push_back(fmt::format("{}: up to {:.0f} % of what it hides is seen in no still, and is made up",
                                  name, std::max(1.0, 100 * most)));
  FrontThing thing;
  for (std::size_t i = 0; i < count; ++i) {
    thing.light.emplace_back(pictures[i].size(), pictures[i].type());
    thing.alpha.emplace_back(pictures[i].size(), pictures[i].type());
    if (pictures[i].depth() == CV_16U)
      part_one<std::uint16_t>(pictures[i], behind[i], mattes[i], thing.light[i], thing.alpha[i]);
    else
      part_one<std::uint8_t>(pictures[i], behind[i], mattes[i], thing.light[i], thing.alpha[i]);
  }
  pictures = std::move(behind);
  return thing;
}

cv::Mat over_grey(const cv::Mat& light, const cv::Mat& alpha) {
  const double most = light.depth() == CV_16U ? 65535 : 255;
  cv::Mat out;
  const cv::Mat mixed = light + (cv::Scalar::all(most) - alpha) * .5;
  mixed.convertTo(out, CV_8U, 255 / most);
  return out;
}

}  // namespace freshet::synth::stills
