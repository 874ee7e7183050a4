#include "synth/transfer/files/design_files.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "cache/content_hash.h"
#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/frame/file_format.h"
#include "media/picture/motion_file.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/video_reader.h"

namespace freshet::synth::transfer {
namespace {

namespace fs = std::filesystem;

constexpr float kUnknown = 1e9f;  // Middlebury's mark

[[noreturn]] void refuse(const std::string& where, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kInput, where, fault, remedy);
}

bool is_sequence(const fs::path& path) {
  std::error_code fault;
  return fs::is_directory(path, fault) || (!fs::exists(path, fault) && media::is_pattern(path));
}

media::PictureSequence list(const fs::path& path, bool (*wanted)(const fs::path&), const std::string& what) {
  const bool folder = fs::is_directory(path);
  media::PictureSequence found = folder ? media::list_folder(path, wanted) : media::list_pattern(path);
  if (found.files.empty())
    refuse(path.string(), "the folder holds no " + what, "Name the folder that does, or a pattern");
  if (const std::optional<fs::path> missing = media::first_missing(found))
    refuse(missing->string(),
           fmt::format("this one is missing between {} and {}", found.files.front().filename().string(),
                       found.files.back().filename().string()),
           "Make it, or number the files without a gap");
  return found;
}

bool is_flo(const fs::path& path) { return media::looks_like_motion(path) && path.extension() == ".flo"; }

// A folder that has a field in both formats, as freshet synth simulate leaves it, is read as .flo: all bits.
bool (*fields_wanted(const fs::path& path))(const fs::path&) {
  std::error_code fault;
  const bool flo = fs::is_directory(path, fault) && !media::list_folder(path, is_flo).files.empty();
  return flo ? is_flo : media::looks_like_motion;
}

// Both readings of a picture as a mask, 0..1; which one holds is known when all have been seen.
struct Masks {
  cv::Mat luma, alpha;
};

Masks masks_of(const cv::Mat& bgra) {
  const double unit = bgra.depth() == CV_16U ? 1.0 / 65535 : 1.0 / 255;
  cv::Mat grey;
  cv::cvtColor(bgra, grey, cv::COLOR_BGRA2GRAY);
  Masks masks;
  grey.convertTo(masks.luma, CV_32F, unit);
  cv::extractChannel(bgra, grey, 3);
  grey.convertTo(masks.alpha, CV_32F, unit);
  for (cv::Mat* mask : {&masks.luma, &masks.alpha}) cv::min(*mask, 1.0, *mask);  // white may round above it
  return masks;
}

}  // namespace

struct DesignFiles::Impl {
  fs::path alpha, flow;
  media::PictureSequence pictures, fields;  // pictures: empty for a video
  std::optional<media::VideoReader> video;
  int next_of_video = 0;

  int asked = 0, frames = 0, empty = 0;
  bool full = true, from_alpha = false;
  cv::Size size;
  std::string hash;

  std::string mask_name(int frame) const {
    return pictures.files.empty() ? fmt::format("{}, frame {}", alpha.string(), frame)
                                  : pictures.files[static_cast<std::size_t>(frame)].string();
  }

  // Nothing after the last frame of a video.
  std::optional<Masks> read_masks(int frame) {
    if (!pictures.files.empty())
      return masks_of(media::read_deep_picture(pictures.files[static_cast<std::size_t>(frame)]).values);
    if (!video || next_of_video > frame) {
      video.emplace(alpha);
      next_of_video = 0;
    }
    std::optional<media::Frame> read;
    while (next_of_video <= frame) {
      read = video->next();
      if (!read) return std::nullopt;
      ++next_of_video;
    }
    Masks masks;
    media::to_luma(*read).convertTo(masks.luma, CV_32F, 1.0 / 255);
    if (media::has_alpha(read->layout))
      masks.alpha = masks_of(media::to_bgra(*read)).alpha;
    else
      masks.alpha = cv::Mat(masks.luma.size(), CV_32F, cv::Scalar(1));
    return masks;
  }

  void check_field(int frame, const cv::Mat& field) const {
    const std::string name = fields.files[static_cast<std::size_t>(frame)].string();
    if (field.size() != size)
      refuse(name,
             fmt::format("it has {} x {} px, the mask {} {} x {}", field.cols, field.rows, mask_name(frame),
                         size.width, size.height),
             "Masks and fields are of one size");
    int wrong = 0;
    cv::Point first;
    for (int y = 0; y < field.rows; ++y)
      for (int x = 0; x < field.cols; ++x) {
        const cv::Vec2f& at = field.at<cv::Vec2f>(y, x);
        if (std::abs(at[0]) <= kUnknown && std::abs(at[1]) <= kUnknown) continue;  // not so for NaN
        if (wrong++ == 0) first = {x, y};
      }
    if (wrong > 0)
      refuse(name,
             fmt::format("{} of its vectors are no numbers, infinite or marked as unknown, the first at "
                         "{}, {}",
                         wrong, first.x, first.y),
             "Set them to 0 where there is no fluid, and to what is nearby elsewhere");
  }

  [[noreturn]] void refuse_lengths(int masks) const {
    const auto fields_there = static_cast<int>(fields.files.size());
    refuse(flow.string(),
           fmt::format("there are {} motion fields, and {} masks in {}", fields_there, masks, alpha.string()),
           fmt::format("Give a field for each mask, or --frames {}", std::min(masks, fields_there)));
  }
};

DesignFiles::DesignFiles(const fs::path& alpha, const fs::path& flow, int frames)
    : impl_(std::make_unique<Impl>()) {
  impl_->alpha = alpha;
  impl_->flow = flow;
  impl_->asked = frames;
  if (is_sequence(alpha))
    impl_->pictures = list(alpha, media::looks_like_picture, "pictures");
  else
    impl_->video.emplace(alpha);
  if (!is_sequence(flow)) {
    if (!fs::exists(flow))
      refuse(flow.string(), "there is no such folder", "Name a folder or a pattern of .flo or .exr");
    refuse(flow.string(), "it is one file; a motion field is needed for each frame",
           "Name the folder of the fields, or a pattern such as flow/%05d.flo");
  }
  impl_->fields = list(flow, fields_wanted(flow), "motion fields (.flo, .exr)");
  const auto fields = static_cast<int>(impl_->fields.files.size());
  const auto masks = static_cast<int>(impl_->pictures.files.size());
  const bool enough =
      frames > 0 ? fields >= frames && (masks == 0 || masks >= frames) : masks == 0 || masks == fields;
  if (!enough && frames > 0)
    refuse(masks != 0 && masks < frames ? alpha.string() : flow.string(),
           fmt::format("it has {} frames, and {} are asked for",
                       masks != 0 && masks < frames ? masks : fields, frames),
           "Ask for fewer with --frames");
  if (!enough) impl_->refuse_lengths(masks);
  impl_->frames = frames > 0 ? frames : fields;
}

DesignFiles::DesignFiles(DesignFiles&&) noexcept = default;
DesignFiles::~DesignFiles() = default;

void DesignFiles::check(const std::function<void(std::size_t, std::size_t)>& progress,
                        const std::stop_token& stop) {
  Impl& design = *impl_;
  cache::KeyHash of_luma, of_alpha, of_flow;
  int luma_empty = 0, alpha_empty = 0;
  bool luma_full = true, alpha_full = true;
  for (int frame = 0; frame < design.frames; ++frame) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "transfer", "stopped");
    const std::optional<Masks> masks = design.read_masks(frame);
    if (!masks && design.asked > 0)
      refuse(design.alpha.string(),
             fmt::format("it has {} frames, and {} are asked for", frame, design.asked),
             "Ask for fewer with --frames");
    if (!masks) design.refuse_lengths(frame);
    if (frame == 0) design.size = masks->luma.size();
    if (masks->luma.size() != design.size)
      refuse(design.mask_name(frame),
             fmt::format("it has {} x {} px, {} {} x {}", masks->luma.cols, masks->luma.rows,
                         design.mask_name(0), design.size.width, design.size.height),
             "All masks are of one size");
    const auto look = [](const cv::Mat& mask, int& empty, bool& full, cache::KeyHash& hash) {
      double minimum = 0, maximum = 0;
      cv::minMaxLoc(mask, &minimum, &maximum);
      empty += maximum <= 0;
      full = full && minimum > 1 - 1e-6;
      cache::add_content(hash, mask);
    };
    look(masks->luma, luma_empty, luma_full, of_luma);
    look(masks->alpha, alpha_empty, alpha_full, of_alpha);
    const cv::Mat field = media::read_motion(design.fields.files[static_cast<std::size_t>(frame)]);
    design.check_field(frame, field);
    cache::add_content(of_flow, field);
    if (progress) progress(static_cast<std::size_t>(frame) + 1, static_cast<std::size_t>(design.frames));
  }
  if (design.asked == 0 && design.pictures.files.empty() && design.read_masks(design.frames)) {
    int masks = design.frames + 1;
    while (design.read_masks(masks)) ++masks;
    design.refuse_lengths(masks);
  }
  design.from_alpha = !alpha_full;
  design.full = design.from_alpha ? alpha_full : luma_full;
  design.empty = design.from_alpha ? alpha_empty : luma_empty;
  design.hash = cache::hex((design.from_alpha ? of_alpha : of_luma).key()) + cache::hex(of_flow.key());
  if (design.empty == design.frames)
    refuse(design.alpha.string(), "the masks are black everywhere in all frames, so nothing in them is fluid",
           "Paint the fluid white");
}

int DesignFiles::frames() const { return impl_->frames; }
cv::Size DesignFiles::size() const { return impl_->size; }
bool DesignFiles::full() const { return impl_->full; }
int DesignFiles::empty_frames() const { return impl_->empty; }
const std::string& DesignFiles::hash() const { return impl_->hash; }

TargetFrame DesignFiles::read(int frame) {
  std::optional<Masks> masks = impl_->read_masks(frame);
  if (!masks) refuse(impl_->alpha.string(), "it changed while it was read", "Start again");
  return {.alpha = impl_->from_alpha ? masks->alpha : masks->luma,
          .flow = media::read_motion(impl_->fields.files[static_cast<std::size_t>(frame)])};
}

}  // namespace freshet::synth::transfer
