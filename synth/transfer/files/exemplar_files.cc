#include "synth/transfer/files/exemplar_files.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "cache/content_hash.h"
#include "freshet/error.h"
#include "media/frame/bgra.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/video_reader.h"
#include "platform/likeness.h"
#include "stored/clip_frames.h"
#include "stored/clip_loop.h"
#include "synth/field/grid.h"
#include "synth/playing/timeline.h"
#include "synth/transfer/files/exemplar_motion.h"

namespace freshet::synth::transfer {
namespace {

namespace fs = std::filesystem;

constexpr int kMax = 65535;
constexpr int kLookedAt = 2;    // frames, to fit it to a design
constexpr int kLeastSide = 48;  // px, of an exemplar that is made smaller here
constexpr double kLeastBody = 0.1;
constexpr int kHalvings = 5;            // of the range of body_begins
constexpr std::size_t kRemembered = 4;  // moments: this one, the one before, and those of a frame begun again

[[noreturn]] void refuse(const std::string& where, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kInput, where, fault, remedy);
}

/// Frames by number, CV_16UC4.
struct Frames {
  std::string name;
  int count = 0;
  std::function<cv::Mat(int)> read;
  std::function<std::string(int)> name_of;
  std::function<std::optional<vision::LoopRule>()> loop;
};

cv::Mat deep(const media::Frame& frame) {
  cv::Mat bgra;
  media::to_bgra(frame).convertTo(bgra, CV_16U, 257);
  return bgra;
}

std::optional<vision::LoopRule> measured_loop(const Frames& frames) {
  if (frames.count < static_cast<int>(vision::kMinLoopFrames)) return std::nullopt;
  vision::LoopFinder finder(1);
  for (int i = 0; i < frames.count; ++i) {
    cv::Mat grey;
    cv::cvtColor(frames.read(i), grey, cv::COLOR_BGRA2GRAY);
    grey.convertTo(grey, CV_8U, 1.0 / 257);
    finder.add(grey);
  }
  return finder.finish();
}

Frames pictures(const fs::path& path) {
  std::vector<fs::path> files{path};
  std::error_code fault;
  const bool folder = fs::is_directory(path, fault);
  if (folder || (!fs::exists(path, fault) && media::is_pattern(path))) {
    media::PictureSequence found = folder ? media::list_folder(path) : media::list_pattern(path);
    if (const std::optional<fs::path> missing = media::first_missing(found))
      refuse(missing->string(),
             fmt::format("this one is missing between {} and {}", found.files.front().filename().string(),
                         found.files.back().filename().string()),
             "Make it, or number the files without a gap");
    files = std::move(found.files);
  }
  return {
      .name = path.string(),
      .count = static_cast<int>(files.size()),
      .read = [files](int i) { return media::read_deep_picture(files[static_cast<std::size_t>(i)]).values; },
      .name_of = [files](int i) { return files[static_cast<std::size_t>(i)].string(); },
      .loop = {}};
}

/// Its frames are kept as the decoder gives them: 1.5 bytes per pixel of 4:2:0.
Frames video(const fs::path& path, std::vector<std::string>& notices) {
  media::VideoReader reader(path, 0, {.upright = true});
  auto frames = std::make_shared<std::vector<media::Frame>>();
  while (std::optional<media::Frame> frame = reader.next()) frames->push_back(std::move(*frame));
  if (!reader.complaint().empty()) notices.push_back(path.string() + ": " + reader.complaint());
  return {.name = path.string(),
          .count = static_cast<int>(frames->size()),
          .read = [frames](int i) { return deep((*frames)[static_cast<std::size_t>(i)]); },
          .name_of = [path](int i) { return fmt::format("{}, frame {}", path.string(), i); },
          .loop = {}};
}

Frames from_file(const fs::path& path, std::vector<std::string>& notices) {
  std::error_code fault;
  const bool sequence =
      fs::is_directory(path, fault) || (!fs::exists(path, fault) && media::is_pattern(path));
  return !sequence && media::looks_like_video(path) ? video(path, notices) : pictures(path);
}

Frames stored(const store::Snapshot& snapshot, const std::string& name) {
  const std::optional<store::ClipId> clip = snapshot.find(name);
  if (!clip) {
    std::vector<std::string> names;
    for (const store::ClipId id : snapshot.clips()) names.push_back(snapshot.clip(id).name);
    throw Error(ErrorKind::kNotFound, name, "the store has no clip of this name",
                did_you_mean(name, names) + "freshet store info lists them");
  }
  auto frames = std::make_shared<stored::ClipFrames>(snapshot, *clip);
  return {.name = name,
          .count = static_cast<int>(frames->size()),
          .read = [frames](int i) { return deep(frames->read(static_cast<std::uint32_t>(i))); },
          .name_of = [name](int i) { return fmt::format("{}, frame {}", name, i); },
          .loop = [snapshot, id = *clip] { return stored::loop_rule(snapshot, id); }};
}

cv::Mat premultiplied(const cv::Mat& bgra) {
  cv::Mat out;
  bgra.convertTo(out, CV_32F, 1.0 / kMax);
  for_rows(out.rows, [&](int y) {
    auto* row = out.ptr<cv::Vec4f>(y);
    for (int x = 0; x < out.cols; ++x)
      for (int c = 0; c < 3; ++c) row[x][c] *= row[x][3];
  });
  return out;
}

cv::Mat straight(const cv::Mat& premultiplied) {
  cv::Mat out(premultiplied.size(), CV_16UC4);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const cv::Vec4f& from = premultiplied.at<cv::Vec4f>(y, x);
      cv::Vec4w& to = out.at<cv::Vec4w>(y, x);
      const float alpha = std::clamp(from[3], 0.0f, 1.0f);
      for (int c = 0; c < 3; ++c)
        to[c] = alpha > 0
                    ? static_cast<std::uint16_t>(std::lround(kMax * std::clamp(from[c] / alpha, 0.0f, 1.0f)))
                    : std::uint16_t{0};
      to[3] = static_cast<std::uint16_t>(std::lround(kMax * alpha));
    }
  return out;
}

}  // namespace

void check_outline(const DesignFiles& design, const ExemplarFiles& exemplar,
                   const std::filesystem::path& masks) {
  if (!exemplar.opaque() && design.full())
    throw Error(
        ErrorKind::kInput, masks.string(),
        "the masks are white everywhere in all frames, so the fluid has no outline to give the exemplar's to",
        "Paint what is no fluid black, or give an opaque exemplar");
}

void check_guides(const ExemplarFiles& exemplar, const TransferOptions& options,
                  const std::filesystem::path& path) {
  if (needs_motion(options) && exemplar.frames() == 1)
    throw Error(ErrorKind::kUsage, path.string(),
                fmt::format("one picture does not move: it has no {}",
                            options.stabilised ? "motion to stabilise" : "divergence"),
                "Leave that option out, or give a video");
  if (options.curvature > 0 && exemplar.opaque())
    throw Error(ErrorKind::kUsage, path.string(),
                "it is opaque, and has no outline whose curvature could count",
                "Leave that option out, or give the exemplar's mask");
}

struct ExemplarFiles::Impl {
  ExemplarOptions options;
  Frames frames;
  std::optional<Frames> masks;
  bool masks_are_alpha = false;  // else grey
  std::vector<std::string> notices;

  cv::Size size;
  bool opaque = true;
  std::optional<vision::LoopRule> loop;
  std::vector<playing::Moment> moments;  // by frame of the animation
  cv::Mat average;                       // of a loop's frames, premultiplied
  std::string hash;
  std::deque<std::pair<int, cv::Mat>> remembered, motions;

  /// One of its own frames, with the alpha and of the size that are asked for.
  cv::Mat own(int frame) const {
    cv::Mat bgra = frames.read(frame);
    const cv::Mat mask = masks ? mask_of(frame, bgra.size()) : cv::Mat();
    if (options.ground != Ground::kNone)
      take_off_ground(bgra, options.ground, mask, options.body_begins);
    else if (masks)
      cv::insertChannel(mask, bgra, 3);
    if (options.scale == 1) return bgra;
    cv::Mat scaled;
    cv::resize(premultiplied(bgra), scaled, {}, options.scale, options.scale,
               options.scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
    return straight(scaled);
  }

  /// Of what the animation will use, and what the motion of one frame leads to.
  int used() const { return std::min(frames.count, std::max(options.motion ? 2 : 1, options.frames)); }

  Extent extent(const TransferOptions& transfer) const {
    return mean_extent(used(), kLookedAt, transfer, [&](int frame) {
      cv::Mat alpha;
      cv::extractChannel(own(frame), alpha, 3);
      alpha.convertTo(alpha, CV_32F, 1.0 / kMax);
      return alpha;
    });
  }

  cv::Mat mask_of(int frame, cv::Size of_frame) const {
    const int of_masks = masks->count == 1 ? 0 : frame;
    const cv::Mat picture = masks->read(of_masks);
    if (picture.size() != of_frame)
      refuse(masks->name_of(of_masks),
             fmt::format("it has {} x {} px, {} {} x {}", picture.cols, picture.rows, frames.name_of(frame),
                         of_frame.width, of_frame.height),
             "Give a mask of the exemplar's size");
    cv::Mat mask;
    if (masks_are_alpha)
      cv::extractChannel(picture, mask, 3);
    else
      cv::cvtColor(picture, mask, cv::COLOR_BGRA2GRAY);
    return mask;
  }

  cv::Mat moment(const playing::Moment& at) const {
    if (at.count() == 1) return own(static_cast<int>(at.at[0]));
    cv::Mat sum = average.clone();
    for (std::size_t i = 0; i < 2; ++i) {
      cv::Mat difference = premultiplied(own(static_cast<int>(at.at[i]))) - average;
      cv::scaleAdd(difference, at.weight[i], sum, sum);
    }
    return straight(sum);
  }

  /// Of a moment by its frame of the animation; a still has one.
  cv::Mat picture(int key) {
    for (const auto& [known, picture] : remembered)
      if (known == key) return picture;
    const cv::Mat picture = moments.empty() ? own(0) : moment(moments[static_cast<std::size_t>(key)]);
    if (remembered.size() == kRemembered) remembered.pop_front();
    remembered.emplace_back(key, picture);
    return picture;
  }

  void open_masks() {
    if (options.alpha.empty()) return;
    masks = from_file(options.alpha, notices);
    if (masks->count != 1 && masks->count != frames.count)
      refuse(options.alpha.string(),
             fmt::format("there are {} masks, and {} has {} frames", masks->count, frames.name, frames.count),
             "Give one for all frames, or one for each");
    for (int i = 0; i < masks->count && !masks_are_alpha; ++i)
      masks_are_alpha = media::is_transparent(masks->read(i));
  }

  void find_moments() {
    if (frames.count == 1) return;
    if (frames.count < options.frames) {
      loop = frames.loop ? frames.loop() : measured_loop(frames);
      if (!loop)
        refuse(frames.name,
               fmt::format(
                   "it has {} frames, too few for an animation of {} and to make a loop of: {} are needed",
                   frames.count, options.frames, vision::kMinLoopFrames),
               "Give a longer one, a single picture, or ask for fewer with --frames");
    }
    std::vector<double> times(static_cast<std::size_t>(frames.count));
    std::iota(times.begin(), times.end(), 0.0);
    moments = playing::timeline(
        times, 1, loop, frames.name,
        {.frames = options.frames, .fps = 1, .speed = 1, .loop = false, .phase = 0, .whole = true});
  }
};

ExemplarFiles::ExemplarFiles(const fs::path& path, const ExemplarOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->frames = from_file(path, impl_->notices);
  impl_->open_masks();
}

ExemplarFiles::ExemplarFiles(const store::Snapshot& snapshot, const std::string& clip,
                             const ExemplarOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->frames = stored(snapshot, clip);
  impl_->open_masks();
}

ExemplarFiles::ExemplarFiles(ExemplarFiles&&) noexcept = default;
ExemplarFiles::~ExemplarFiles() = default;

void ExemplarFiles::fit_scale(const Extent& design, const TransferOptions& options) {
  Impl& exemplar = *impl_;
  const Extent own = exemplar.extent(options);
  if (own.boundary == 0 || own.all() <= design.all()) return;
  const cv::Size size = exemplar.frames.read(0).size();
  const double least = static_cast<double>(kLeastSide) / std::min(size.width, size.height);
  exemplar.options.scale = std::clamp(std::sqrt(design.all() / own.all()), std::min(1.0, least), 1.0);
}

void ExemplarFiles::fit_body(const Extent& design, const TransferOptions& options) {
  Impl& exemplar = *impl_;
  if (exemplar.options.ground != Ground::kBlack || exemplar.masks) return;
  // The more light it takes, the less is interior.
  double low = kLeastBody, high = 1;
  for (int halving = 0; halving < kHalvings; ++halving) {
    exemplar.options.body_begins = 0.5 * (low + high);
    const bool too_much = exemplar.extent(options).interior_share() > design.interior_share();
    (too_much ? low : high) = exemplar.options.body_begins;
  }
}

void ExemplarFiles::check(const std::function<void(std::size_t, std::size_t)>& progress,
                          const std::stop_token& stop) {
  Impl& exemplar = *impl_;
  exemplar.find_moments();
  const int used = exemplar.used();
  cache::KeyHash hash;
  double max_alpha = 0;
  for (int i = 0; i < used; ++i) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "transfer", "stopped");
    const cv::Mat bgra = exemplar.own(i);
    const std::string name = exemplar.frames.name_of(i);
    if (i == 0) {
      exemplar.size = bgra.size();
      const int minimum = 2 * exemplar.options.patch;
      if (bgra.cols < minimum || bgra.rows < minimum)
        refuse(name,
               fmt::format("the exemplar is {} x {} px; two patches of {} px need {}", bgra.cols, bgra.rows,
                           exemplar.options.patch, minimum),
               "Give a larger one, or a smaller --patch");
    }
    if (bgra.size() != exemplar.size)
      refuse(name,
             fmt::format("it has {} x {} px, the first frame {} x {}", bgra.cols, bgra.rows,
                         exemplar.size.width, exemplar.size.height),
             "Make all frames equal in size");
    cv::Mat alpha;
    cv::extractChannel(bgra, alpha, 3);
    double minimum = 0, maximum = 0;
    cv::minMaxLoc(alpha, &minimum, &maximum);
    exemplar.opaque = exemplar.opaque && minimum == kMax;
    max_alpha = std::max(max_alpha, maximum);
    if (maximum == 0 && used > 1 && i == 0)
      refuse(name,
             "the exemplar's first frame is transparent everywhere: there is no fluid in it to begin with",
             "Cut off the frames before the fluid");
    alpha.convertTo(alpha, CV_32F, 1.0 / kMax);
    const TransferOptions shows{.radius = exemplar.options.radius, .lower = exemplar.options.lower};
    if (max_alpha > 0 && extent_of(alpha, shows).all() == 0)
      refuse(name,
             fmt::format("its blurred alpha is nowhere above {}: there is no fluid in it",
                         exemplar.options.lower),
             "Lower --lower, cut such frames off, or give masks with --exemplar-alpha");
    cache::add_content(hash, bgra);
    if (exemplar.loop) {
      if (exemplar.average.empty()) exemplar.average = cv::Mat(bgra.size(), CV_32FC4, cv::Scalar::all(0));
      exemplar.average += premultiplied(bgra);
    }
    if (progress) progress(static_cast<std::size_t>(i) + 1, static_cast<std::size_t>(used));
  }
  if (max_alpha == 0)
    refuse(exemplar.options.alpha.empty() ? exemplar.frames.name : exemplar.options.alpha.string(),
           "the exemplar is transparent everywhere: there is no fluid in it",
           "Give a mask that is white where the fluid is with --exemplar-alpha");
  if (exemplar.loop) exemplar.average /= used;
  exemplar.hash = cache::hex(hash.key());
}

const ExemplarOptions& ExemplarFiles::options() const { return impl_->options; }
int ExemplarFiles::frames() const { return impl_->frames.count; }
cv::Size ExemplarFiles::size() const { return impl_->size; }
bool ExemplarFiles::opaque() const { return impl_->opaque; }
std::optional<vision::LoopRule> ExemplarFiles::loop() const { return impl_->loop; }
const std::string& ExemplarFiles::hash() const { return impl_->hash; }
const std::vector<std::string>& ExemplarFiles::notices() const { return impl_->notices; }

ExemplarFrame ExemplarFiles::at(int t) {
  Impl& exemplar = *impl_;
  const int key =
      exemplar.moments.empty() ? 0 : std::clamp(t, 0, static_cast<int>(exemplar.moments.size()) - 1);
  ExemplarFrame frame{exemplar.picture(key)};
  if (!exemplar.options.motion || exemplar.frames.count == 1) return frame;
  for (const auto& [known, back] : exemplar.motions)
    if (known == key) return {frame.bgra, back};
  const bool is_light = exemplar.options.ground == Ground::kBlack;
  frame.back =
      key > 0
          ? motion_between(frame.bgra, exemplar.picture(key - 1), is_light)
          : cv::Mat(-motion_between(
                frame.bgra, exemplar.moments.size() > 1 ? exemplar.picture(1) : exemplar.own(1), is_light));
  if (exemplar.motions.size() == kRemembered) exemplar.motions.pop_front();
  exemplar.motions.emplace_back(key, frame.back);
  return frame;
}

}  // namespace freshet::synth::transfer
