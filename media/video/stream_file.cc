#include "media/video/stream_file.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include <opencv2/imgproc.hpp>

extern "C" {
#include <libavutil/opt.h>
}

#include "freshet/error.h"
#include "media/frame/scaler.h"
#include "media/picture/picture_file.h"
#include "platform/standard_descriptors.h"

namespace freshet::media {
namespace {

// Fixed, because x264's bytes depend on the number of its threads; FFV1's only on that of its slices.
constexpr int kThreads = 4;
constexpr int kFfv1Slices = 4;
constexpr int kSmallestSliced = 8;  // px; half of it in planes of chroma
constexpr std::int64_t kKeyEvery_s = 60;
constexpr AVRational kMillisecond{1, 1000};  // what Matroska counts in
constexpr const char* kWebpQuality = "90";
// Of two animations of water at crf 16 the preset alone codes in .6 of the time of "medium", to files .99 and 1.03 as
// large and SSIM .9896 and .9957 after .9901 and .9962. Encoding was a quarter of a run's time. Of 40 frames of falls
// of 1920 x 1080 its trellis and finer motion search took a third of what coding took. Without them a file of 1.95 MB
// is .09 dB worse and SSIM .0001 better than with them at a crf that gives 1.94 MB.
constexpr const char* kX264Preset = "faster";
// Its AVX-512 code reads memory that nobody wrote where a picture is not a multiple of 256 px wide (0.164: bytes
// differed from run to run, by what lay on the heap); and each width of vectors gives other bytes. What does not depend
// on the processor does neither, and is as fast. It looks ahead by 10 frames, in the thread that codes: by 20, in one
// of its own, 96 frames of 3840 x 2160 took .34 GB more, to a file as large and no better.
constexpr const char* kX264Params =
    "scenecut=0:cpu-independent=1:trellis=0:me=dia:subme=3:rc-lookahead=10:sync-lookahead=0";

struct Codec {
  const char* muxer;
  const char* encoder;
};

// Their names in FFmpeg.
Codec codec_of(Coding coding) {
  switch (coding) {
    case Coding::kH264:
      return {"mp4", "libx264"};
    case Coding::kFfv1:
      return {"matroska", "ffv1"};
    case Coding::kProRes:
      return {"mov", "prores_ks"};
    case Coding::kWebp:
      return {"webp", "libwebp_anim"};
    case Coding::kApng:
      return {"apng", "apng"};
    case Coding::kGif:
      return {"gif", "gif"};
    case Coding::kNone:
    case Coding::kPicture:
    case Coding::kExr:
      break;
  }
  assert(!"a film's coding");
  return {};
}

PixelLayout layout_of_picture(const cv::Mat& picture) {
  PixelLayout layout;
  if (picture.depth() == CV_16U)
    layout.format = picture.channels() == 4 ? "bgra64le" : "bgr48le";
  else
    layout.format = picture.channels() == 4 ? "bgra" : "bgr24";
  layout.width = picture.cols;
  layout.height = picture.rows;
  layout.range = AVCOL_RANGE_JPEG;
  layout.matrix = AVCOL_SPC_RGB;
  layout.primaries = AVCOL_PRI_BT709;
  layout.transfer = AVCOL_TRC_IEC61966_2_1;
  return layout;
}

// How a BGR picture of `given` is coded.
PixelLayout coded_picture(const PixelLayout& given, Coding coding, int bits) {
  const bool deep = given.format == "bgra64le" || given.format == "bgr48le";
  const bool alpha = given.format == "bgra" || given.format == "bgra64le";
  PixelLayout coded = given;
  switch (coding) {
    case Coding::kH264:
      coded.format = bits == 10 ? "yuv420p10le" : "yuv420p";
      coded.range = AVCOL_RANGE_MPEG;
      coded.matrix = AVCOL_SPC_BT709;
      coded.transfer = AVCOL_TRC_BT709;
      break;
    case Coding::kFfv1:
      coded.format = deep ? (alpha ? "gbrap16le" : "gbrp16le") : (alpha ? "bgra" : "bgr0");
      break;
    case Coding::kProRes:
      coded.format = alpha ? "yuva444p10le" : "yuv444p10le";
      coded.range = AVCOL_RANGE_MPEG;
      coded.matrix = AVCOL_SPC_BT709;
      coded.transfer = AVCOL_TRC_BT709;
      break;
    case Coding::kWebp:
      coded.format = "bgra";
      break;
    case Coding::kApng:
      coded.format = alpha ? "rgba" : "rgb24";
      break;
    case Coding::kGif:
      coded.format = "pal8";
      break;
    case Coding::kNone:
    case Coding::kPicture:
    case Coding::kExr:
      break;
  }
  return coded;
}

bool codes(const AVCodec& codec, AVPixelFormat format) {
  for (const AVPixelFormat* known = codec.pix_fmts; known && *known != AV_PIX_FMT_NONE; ++known)
    if (*known == format) return true;
  return false;
}

// Formats that hold the same samples in another order, for those that FFV1 does not take.
std::string repacked(const std::string& format) {
  static constexpr std::pair<std::string_view, std::string_view> kSame[] = {
      {"rgb24", "bgr0"},   {"bgr24", "bgr0"},      {"rgb0", "bgr0"},       {"0rgb", "bgr0"},
      {"0bgr", "bgr0"},    {"gbrp", "bgr0"},       {"rgba", "bgra"},       {"argb", "bgra"},
      {"abgr", "bgra"},    {"gbrap", "bgra"},      {"nv12", "yuv420p"},    {"nv21", "yuv420p"},
      {"nv16", "yuv422p"}, {"yuyv422", "yuv422p"}, {"uyvy422", "yuv422p"}, {"p010le", "yuv420p10le"}};
  for (const auto& [from, to] : kSame)
    if (from == format) return std::string(to);
  return format;
}

}  // namespace

StreamFile::CoderOptions::~CoderOptions() {
  av_dict_free(&coding);
  av_dict_free(&muxing);
}

void StreamFile::CloseContainer::operator()(AVFormatContext* container) const {
  if (container->pb) avio_closep(&container->pb);
  avformat_free_context(container);
}

StreamFile::StreamFile(std::filesystem::path path, Coding coding, const VideoWriterOptions& options)
    : path_(std::move(path)), coding_(coding), options_(options) {
  quiet_libav();
  require_folder_of(path_);
  temporary_ = temporary_beside(path_);
  unfinished_.emplace(temporary_);
  packet_ = new_packet();
  AVFormatContext* container = nullptr;
  const std::string url = "file:" + temporary_.string();
  int code = avformat_alloc_output_context2(&container, nullptr, codec_of(coding_).muxer, url.c_str());
  if (code < 0) fail(code, "FFmpeg's muxer cannot be opened");
  container_.reset(container);
  container_->flags |= AVFMT_FLAG_BITEXACT;
  const StandardDescriptors standing_in;
  code = avio_open(&container_->pb, url.c_str(), AVIO_FLAG_WRITE);
  if (code < 0) fail(code, "cannot be created");
}

StreamFile::~StreamFile() {
  container_.reset();
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
}

void StreamFile::fail(int code, const std::string& doing) {
  const bool disk = code == AVERROR(ENOSPC) || code == AVERROR(EFBIG);
  throw Error(ErrorKind::kIo, path_.string(), doing + " (" + libav_fault(code) + ")",
              disk ? "Make room on the disk" : "Check the folder, its permissions and the frame size");
}

StreamFile::CoderOptions StreamFile::set_coding() {
  CoderOptions options;
  switch (coding_) {
    case Coding::kH264:
      // A key frame codes anew what stands still: with one every two seconds a waterfall's rocks jumped by .34 grey
      // levels at each (.10 at most elsewhere), and lower ratios of quantisers did not help. So there is the first,
      // and another every minute for players that jump; scene cuts are none of ours.
      context_->gop_size = static_cast<int>(
          std::clamp<std::int64_t>(kKeyEvery_s * options_.fps_num / options_.fps_den, 1, 1 << 20));
      av_dict_set(&options.coding, "x264-params", kX264Params, 0);
      context_->flags |= AV_CODEC_FLAG_CLOSED_GOP;
      av_dict_set(&options.coding, "preset", kX264Preset, 0);
      av_dict_set_int(&options.coding, "crf", options_.crf, 0);
      if (options_.crf > 0)
        av_dict_set(&options.coding, "profile", options_.bits == 10 ? "high10" : "high",
                    0);  // lossless is above High
      av_dict_set(&options.muxing, "movflags", "+faststart", 0);
      break;
    case Coding::kFfv1:
      context_->gop_size = 1;
      // Level 3 refuses, or loses, slices of less than a pixel: FFmpeg 5.1 gives 1 x 9 and 2 x 2 px back black.
      context_->level = std::min(context_->width, context_->height) < kSmallestSliced ? 1 : 3;
      if (context_->level < 3) break;
      context_->slices = kFfv1Slices;
      av_dict_set(&options.coding, "slicecrc", "1", 0);
      break;
    case Coding::kProRes:
      av_dict_set(&options.coding, "profile", "4444", 0);
      av_dict_set(&options.coding, "vendor", "apl0", 0);  // some programs open no other maker's
      av_dict_set(&options.coding, "alpha_bits", "16", 0);
      break;
    case Coding::kWebp:
      av_dict_set(&options.coding, "quality", kWebpQuality, 0);
      av_dict_set(&options.muxing, "loop", "0", 0);
      break;
    case Coding::kApng:
      av_dict_set(&options.muxing, "plays", "0", 0);
      break;
    case Coding::kGif:
      av_dict_set(&options.muxing, "loop", "0", 0);
      break;
    case Coding::kNone:
    case Coding::kPicture:
    case Coding::kExr:
      break;
  }
  return options;
}

void StreamFile::open(const PixelLayout& coded) {
  const AVCodec* codec = avcodec_find_encoder_by_name(codec_of(coding_).encoder);
  if (!codec)
    throw Error(ErrorKind::kIo, path_.string(),
                std::string("this FFmpeg has no encoder ") + codec_of(coding_).encoder,
                "Install FFmpeg with it or choose another ending");
  const AVPixelFormat format = av_get_pix_fmt(coded.format.c_str());
  if (!codes(*codec, format))
    throw Error(ErrorKind::kUsage, path_.string(),
                std::string(codec->name) + " cannot hold the pixel format " + coded.format,
                "Export pictures instead");
  context_.reset(avcodec_alloc_context3(codec));
  if (!context_) throw std::bad_alloc();
  context_->width = coded.width;
  context_->height = coded.height;
  context_->pix_fmt = format;
  const AVRational interval{static_cast<int>(options_.fps_den), static_cast<int>(options_.fps_num)};
  context_->time_base = options_.own_times ? kMillisecond : interval;
  context_->framerate = options_.own_times ? AVRational{0, 1} : av_inv_q(interval);
  context_->sample_aspect_ratio = {coded.sar_num, coded.sar_den};
  context_->color_range = static_cast<AVColorRange>(coded.range);
  context_->colorspace = static_cast<AVColorSpace>(coded.matrix);
  context_->color_primaries = static_cast<AVColorPrimaries>(coded.primaries);
  context_->color_trc = static_cast<AVColorTransferCharacteristic>(coded.transfer);
  context_->flags |= AV_CODEC_FLAG_BITEXACT;
  context_->thread_count = kThreads;
  if (container_->oformat->flags & AVFMT_GLOBALHEADER) context_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;

  CoderOptions options = set_coding();
  int code = avcodec_open2(context_.get(), codec, &options.coding);
  if (code >= 0) {
    stream_ = avformat_new_stream(container_.get(), nullptr);
    if (!stream_) throw std::bad_alloc();
    stream_->time_base = context_->time_base;
    stream_->avg_frame_rate = context_->framerate;
    stream_->sample_aspect_ratio = context_->sample_aspect_ratio;
    // Matroska holds no display matrix; players and our reader take this tag.
    if (coded.rotation != 0) av_dict_set_int(&stream_->metadata, "rotate", coded.rotation, 0);
    code = avcodec_parameters_from_context(stream_->codecpar, context_.get());
  }
  if (code >= 0) code = avformat_write_header(container_.get(), &options.muxing);
  if (code < 0)
    fail(code, "encoding " + std::to_string(coded.width) + " x " + std::to_string(coded.height) + " as " +
                   codec_of(coding_).encoder + " cannot begin");
}

void StreamFile::encode(const AVFrame* frame) {
  int code = avcodec_send_frame(context_.get(), frame);
  while (code >= 0) {
    code = avcodec_receive_packet(context_.get(), packet_.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
    if (code < 0) break;
    if (packet_->duration == 0 && !options_.own_times) packet_->duration = 1;
    packet_->stream_index = stream_->index;
    av_packet_rescale_ts(packet_.get(), context_->time_base, stream_->time_base);
    code = av_interleaved_write_frame(container_.get(), packet_.get());
  }
  if (code < 0) fail(code, "frame " + std::to_string(frames_) + " cannot be written");
}

void StreamFile::convert_and_encode(const PixelLayout& layout, const Frame& source,
                                    const PixelLayout& coded) {
  quiet_libav();
  if (!context_) {
    open(coded);
    first_ = layout;
  } else if (first_.format != layout.format || first_.width != layout.width ||
             first_.height != layout.height) {
    throw Error(ErrorKind::kUsage, path_.string(),
                "frame " + std::to_string(frames_) + " is " + layout.format + " " +
                    std::to_string(layout.width) + "x" + std::to_string(layout.height) + ", the first was " +
                    first_.format + " " + std::to_string(first_.width) + "x" + std::to_string(first_.height),
                "Write frames that are all alike");
  }
  AvOwner<AVFrame> frame = new_frame();
  frame->width = coded.width;
  frame->height = coded.height;
  frame->format = context_->pix_fmt;
  frame->pts = options_.own_times ? std::llround(source.time_s / av_q2d(kMillisecond)) : frames_;
  frame->color_range = context_->color_range;
  frame->colorspace = context_->colorspace;
  frame->color_primaries = context_->color_primaries;
  frame->color_trc = context_->color_trc;
  frame->sample_aspect_ratio = context_->sample_aspect_ratio;
  // A frame a call: encoders keep what they were sent.
  const int code = av_frame_get_buffer(frame.get(), 0);
  if (code < 0) fail(code, "no memory for a frame");
  const Image from = image_of(source);
  if (coded.format == layout.format) {
    for (std::size_t i = 0; i < source.planes.size(); ++i) {
      const Plane& plane = source.planes[i];
      for (int y = 0; y < plane.height; ++y)
        std::memcpy(frame->data[i] + static_cast<std::ptrdiff_t>(y) * frame->linesize[i],
                    plane.data + y * plane.stride,
                    static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.bytes_per_sample));
    }
  } else {
    Image to;
    for (std::size_t i = 0; i < to.data.size(); ++i) {
      to.data[i] = frame->data[i];
      to.stride[i] = frame->linesize[i];
    }
    convert(layout, from, coded, to);
  }
  encode(frame.get());
  ++frames_;
}

void StreamFile::write_to_palette(const cv::Mat& picture) {
  quiet_libav();
  AvOwner<AVFrame> frame = new_frame();
  frame->width = picture.cols;
  frame->height = picture.rows;
  frame->format = AV_PIX_FMT_BGRA;
  frame->pts = frames_++;
  if (const int code = av_frame_get_buffer(frame.get(), 0); code < 0) fail(code, "no memory for a frame");
  cv::Mat to(picture.size(), CV_8UC4, frame->data[0], static_cast<std::size_t>(frame->linesize[0]));
  cv::cvtColor(picture, to, cv::COLOR_BGR2BGRA);
  // Ordered dither keeps still what stands still; error diffusion makes it tremble.
  if (!palette_)
    palette_.emplace("split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=bayer:bayer_scale=3", *frame,
                     AVRational{static_cast<int>(options_.fps_den), static_cast<int>(options_.fps_num)},
                     path_.string(), AV_PIX_FMT_PAL8);
  palette_->push(frame.get());
}

void StreamFile::write(const cv::Mat& picture) {
  if (coding_ == Coding::kGif) return write_to_palette(picture);
  cv::Mat even = picture;
  // 4:2:0 has one chroma sample for two columns and rows.
  if (coding_ == Coding::kH264 && (picture.cols % 2 != 0 || picture.rows % 2 != 0))
    cv::copyMakeBorder(picture, even, 0, picture.rows % 2, 0, picture.cols % 2, cv::BORDER_REPLICATE);
  Frame source;
  source.layout = layout_of_picture(even);
  source.planes = plane_shapes(source.layout);
  source.planes[0].data = reinterpret_cast<std::byte*>(even.data);
  source.planes[0].stride = static_cast<std::ptrdiff_t>(even.step[0]);
  convert_and_encode(source.layout, source, coded_picture(source.layout, coding_, options_.bits));
}

void StreamFile::write(const Frame& frame) {
  PixelLayout coded = frame.layout;
  const AVCodec* codec = avcodec_find_encoder_by_name(codec_of(coding_).encoder);
  if (codec && !codes(*codec, av_get_pix_fmt(coded.format.c_str()))) coded.format = repacked(coded.format);
  convert_and_encode(frame.layout, frame, coded);
}

void StreamFile::finish() {
  quiet_libav();
  if (palette_) {
    palette_->push(nullptr);
    frames_ = 0;
    while (const AvOwner<AVFrame> frame = palette_->pull()) {
      if (!context_) {
        PixelLayout coded;
        coded.format = "pal8";
        coded.width = frame->width;
        coded.height = frame->height;
        open(coded);
      }
      frame->pts = frames_++;
      encode(frame.get());
    }
  }
  if (!context_)
    throw Error(ErrorKind::kUsage, path_.string(), "no frame was written to it", "Write at least one");
  encode(nullptr);
  int code = av_write_trailer(container_.get());
  const int closed = avio_closep(&container_->pb);
  if (code >= 0) code = closed;
  if (code < 0) fail(code, "cannot be completed");
  move_into_place(std::exchange(temporary_, {}), path_);
}

}  // namespace freshet::media
