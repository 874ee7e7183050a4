#include "media/video/video_writer.h"

#include <optional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/picture/picture_file.h"
#include "media/picture/picture_sequence.h"
#include "media/video/stream_file.h"
#include "platform/text.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

void require_size(const fs::path& path, const OutputFormat& format, cv::Size size) {
  const int longest = format.max_side();
  if (size.width > longest || size.height > longest)
    throw Error(ErrorKind::kUsage, path.string(),
                "frames of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                    " px, and its format takes " + std::to_string(longest) + " a side",
                "Choose .mkv or a sequence such as frames/%05d.png, or reduce the picture");
}

// A native frame as a picture file can hold it: 16-bit grey and RGB as they are, the rest as 8-bit BGR.
cv::Mat picture_of(const Frame& frame) {
  const std::string& format = frame.layout.format;
  const bool grey = format == "gray16le", colour = format == "rgb48le";
  if (!grey && !colour) return to_bgr(frame);
  const cv::Mat samples(frame.layout.height, frame.layout.width, grey ? CV_16UC1 : CV_16UC3,
                        frame.planes[0].data, static_cast<std::size_t>(frame.planes[0].stride));
  if (grey) return samples;
  cv::Mat bgr;
  cv::cvtColor(samples, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

}  // namespace

std::string size_notice(const fs::path& path, cv::Size size) {
  if (output_format(path).coding() != Coding::kH264) return {};
  std::string text;
  if (const cv::Size even(size.width + size.width % 2, size.height + size.height % 2); even != size)
    text = "H.264 takes even sides only: the video has " + std::to_string(even.width) + " x " +
           std::to_string(even.height) + " px, the picture " + std::to_string(size.width) + " x " +
           std::to_string(size.height) + "; its last column or row is repeated";
  if (std::int64_t{size.width} * size.height > std::int64_t{4096} * 2304)
    text +=
        std::string(text.empty() ? "" : ". ") + "Above 4096 x 2304 px many players and phones show no H.264";
  return text;
}

struct VideoWriter::Impl {
  fs::path path;
  cv::Size size;
  VideoWriterOptions options;
  OutputFormat format;
  std::optional<StreamFile> file;  // nothing: a sequence
  std::int64_t pictures = 0;
  bool finished = false;

  Impl(const fs::path& target, cv::Size frame, const VideoWriterOptions& asked)
      : path(target), size(frame), options(asked), format(output_format(target)) {}

  void require_open(cv::Size given) const {
    if (finished) throw Error(ErrorKind::kUsage, path.string(), "a frame came after finish()");
    if (given != size)
      throw Error(ErrorKind::kUsage, path.string(),
                  "a frame of " + std::to_string(given.width) + " x " + std::to_string(given.height) +
                      " was given, the video is " + std::to_string(size.width) + " x " +
                      std::to_string(size.height),
                  "Write frames that are all alike");
  }
  void write_next(const cv::Mat& picture) {
    const fs::path name = numbered(path, options.first_number + pictures++);
    if (picture.depth() == CV_32F)
      write_exr_picture(name, picture, options.exr);
    else
      write_picture(name, picture);
  }
};

VideoWriter::VideoWriter(const fs::path& path, cv::Size size, const VideoWriterOptions& options)
    : impl_(std::make_unique<Impl>(path, size, options)) {
  constexpr std::int64_t kMaxRate = 1 << 30;
  if (size.width < 1 || size.height < 1 || size.width > (1 << 16) || size.height > (1 << 16))
    throw Error(ErrorKind::kUsage, path.string(),
                "the frame size " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                    " is out of range");
  if (options.fps_num < 1 || options.fps_den < 1 || options.fps_num > kMaxRate || options.fps_den > kMaxRate)
    throw Error(ErrorKind::kUsage, path.string(), "the frame rate is out of range",
                "Give it as 25 or 30000/1001");
  if (options.crf < 0 || options.crf > 51)
    throw Error(ErrorKind::kUsage, path.string(), "crf is out of range", "Choose 0 (lossless) to 51");
  require_size(path, impl_->format, size);
  if (impl_->format.form() == OutputFormat::Form::kFilm)
    impl_->file.emplace(path, impl_->format.coding(), options);
  else
    require_folder_of(path);
}

VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

void VideoWriter::write(const cv::Mat& picture) {
  impl_->require_open(picture.size());
  const OutputFormat& format = impl_->format;
  const int depth = picture.depth();
  if ((depth == CV_32F) != format.light())
    throw Error(
        ErrorKind::kUsage, impl_->path.string(),
        format.light() ? "it holds linear light, CV_32F" : "linear light goes into sequences of .exr alone");
  if ((depth != CV_8U && depth != CV_16U && depth != CV_32F) ||
      (picture.channels() != 3 && picture.channels() != 4))
    throw Error(ErrorKind::kUsage, impl_->path.string(),
                "a picture that is not BGR or BGRA of 8 or 16 bits was given");
  if (picture.channels() == 4 && !format.alpha())
    throw Error(ErrorKind::kUsage, impl_->path.string(), "the format holds no alpha channel",
                "Use " + written_endings([](const FileFormat& each) { return each.alpha; }));
  if (depth == CV_16U && format.samples(impl_->options.bits) == Samples::k8)
    throw Error(ErrorKind::kUsage, impl_->path.string(), "it holds 8 bits per channel, not 16",
                "Use .mkv, .mov or a sequence");
  if (impl_->file)
    impl_->file->write(picture);
  else
    impl_->write_next(picture);
}

void VideoWriter::write(const Frame& frame) {
  impl_->require_open({frame.layout.width, frame.layout.height});
  if (!impl_->file) return impl_->write_next(as_held(picture_of(frame), impl_->format));
  if (impl_->format.coding() != Coding::kFfv1)
    throw Error(ErrorKind::kUsage, impl_->path.string(),
                "native frames are written losslessly, which this is not", "Use .mkv");
  impl_->file->write(frame);
}

void VideoWriter::finish() {
  if (impl_->finished) return;
  if (impl_->file) {
    impl_->file->finish();
    impl_->file.reset();
  }
  impl_->finished = true;
}

}  // namespace freshet::media
