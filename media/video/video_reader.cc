#include "media/video/video_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

extern "C" {
#include <libavutil/display.h>
}

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/frame/filter_graph.h"
#include "media/frame/plain_frame.h"
#include "media/picture/picture_sequence.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

constexpr AVRational kFallbackRate{25, 1};  // of sequences, and of files that give none

bool is_rate(AVRational rate) { return rate.num > 0 && rate.den > 0 && av_q2d(rate) <= 1000; }

int quarter_turns(double degrees) {
  if (!std::isfinite(degrees)) return 0;
  return static_cast<int>((std::lround(degrees / 90) % 4 + 4) % 4) * 90;
}

// Degrees clockwise. FFmpeg's function gives them anticlockwise.
int rotation_of(const AVFrame& frame, const AVStream& stream) {
  if (const AVFrameSideData* side = av_frame_get_side_data(&frame, AV_FRAME_DATA_DISPLAYMATRIX);
      side && side->size >= 9 * sizeof(std::int32_t))
    return quarter_turns(-av_display_rotation_get(reinterpret_cast<const std::int32_t*>(side->data)));
  std::size_t bytes = 0;
  const std::uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
  if (matrix && bytes >= 9 * sizeof(std::int32_t))
    return quarter_turns(-av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix)));
  // Matroska has no matrix; the tag is what writers put there, ours too.
  if (const AVDictionaryEntry* tag = av_dict_get(stream.metadata, "rotate", nullptr, 0))
    return quarter_turns(std::atof(tag->value));
  return 0;
}

std::string of(std::int64_t part, std::int64_t whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

// HDR that does not say its primaries or its matrix has those of BT.2020, as ITU-R BT.2100 wants.
std::string missing_hdr_tags(const AVFrame& frame) {
  std::string tags;
  if (frame.color_primaries == AVCOL_PRI_UNSPECIFIED) tags += ":color_primaries=bt2020";
  if (frame.colorspace == AVCOL_SPC_UNSPECIFIED) tags += ":colorspace=bt2020nc";
  return tags.empty() ? "" : "setparams=" + tags.substr(1) + ",";
}

}  // namespace

struct VideoReader::Impl {
  fs::path path;
  int threads = 0;
  VideoInfo info;
  std::string complaint;

  std::optional<Decoder> decoder;  // of a file
  Repairs repairs;
  std::optional<FilterGraph> graph;  // that makes them
  bool looked_at = false;            // whether the first frame was, for what has to be done
  AVRational aspect{0, 1};           // of that frame, as it was stored
  bool all_pushed = false;
  struct {
    int width = 0, height = 0, format = -1;
  } repaired_format;         // of the first frame
  PictureSequence sequence;  // of a folder or a pattern
  std::size_t next_file = 0;
  std::vector<std::string> broken_files;

  std::optional<Frame> first;  // decoded when opened, for only a frame shows its layout
  std::int64_t delivered = 0;
  std::int64_t first_pts = AV_NOPTS_VALUE;
  double last_time_s = 0, frame_s = 0;
  bool at_end = false;

  void open_file();
  void open_sequence();
  std::optional<Frame> decode();
  void set_up_filters(const AVFrame& frame);
  AvOwner<AVFrame> next_repaired();
  std::optional<Frame> decode_file();
  std::optional<Frame> decode_picture();
  Frame accept(AvOwner<AVFrame> frame, const AVStream& stream, const fs::path& where);
  double time_of(std::int64_t pts, AVRational time_base);
  void conclude();
};

void VideoReader::Impl::open_file() {
  decoder.emplace(path, DecoderOptions{.threads = threads});
  const AVStream& stream = decoder->stream();
  info.codec = avcodec_get_name(decoder->codec());
  info.container = decoder->container().iformat->name;
  AVRational rate = stream.avg_frame_rate;
  if (!is_rate(rate)) rate = stream.r_frame_rate;
  if (!is_rate(rate)) rate = kFallbackRate;
  info.fps_num = rate.num;
  info.fps_den = rate.den;
  info.claimed_frames = decoder->listed_frames();
  if (stream.duration > 0)
    info.claimed_duration_s = static_cast<double>(stream.duration) * av_q2d(stream.time_base);
  else if (decoder->container().duration > 0 &&
           decoder->container().duration_estimation_method != AVFMT_DURATION_FROM_BITRATE)
    info.claimed_duration_s = static_cast<double>(decoder->container().duration) / AV_TIME_BASE;
  frame_s = 1 / av_q2d(rate);
}

void VideoReader::Impl::open_sequence() {
  if (repairs.any())
    throw Error(ErrorKind::kInput, path.string(), "a picture sequence is not repaired",
                "Ingest it without repairs, or make a video of it with ffmpeg first");
  sequence = fs::is_directory(path) ? list_folder(path) : list_pattern(path);
  info.container = "picture sequence";
  info.fps_num = kFallbackRate.num;
  info.fps_den = kFallbackRate.den;
  info.claimed_frames = static_cast<std::int64_t>(sequence.files.size());
  frame_s = 1 / av_q2d(kFallbackRate);
  info.claimed_duration_s =
      static_cast<double>(sequence.numbers.back() - sequence.numbers.front() + 1) * frame_s;
}

// Seconds from the first frame, always later than the frame before: a missing or repeated stamp counts as one
// frame of the average rate.
double VideoReader::Impl::time_of(std::int64_t pts, AVRational time_base) {
  if (first_pts == AV_NOPTS_VALUE) first_pts = pts;
  if (delivered == 0) return last_time_s = 0;
  double time = last_time_s + frame_s;
  if (pts != AV_NOPTS_VALUE && first_pts != AV_NOPTS_VALUE) {
    const double stamped = (static_cast<double>(pts) - static_cast<double>(first_pts)) * av_q2d(time_base);
    if (stamped > last_time_s) time = stamped;
  }
  return last_time_s = time;
}

Frame VideoReader::Impl::accept(AvOwner<AVFrame> frame, const AVStream& stream, const fs::path& where) {
  const auto format = static_cast<AVPixelFormat>(frame->format);
  const char* name = av_get_pix_fmt_name(format);
  if (plain_format(format) == AV_PIX_FMT_NONE)
    throw Error(ErrorKind::kInput, where.string(),
                std::string("frames in the pixel format ") + (name ? name : "unknown") + " cannot be kept",
                "Convert it to FFV1 with ffmpeg -pix_fmt yuv420p or rgb24");
  PixelLayout layout = layout_of(*frame);
  if (delivered == 0) {
    if (!looked_at)
      aspect = av_guess_sample_aspect_ratio(nullptr, const_cast<AVStream*>(&stream), frame.get());
    if (aspect.num > 0 && aspect.den > 0) {
      layout.sar_num = aspect.num;
      layout.sar_den = aspect.den;
      if (info.turned % 180 != 0) std::swap(layout.sar_num, layout.sar_den);
    }
    layout.rotation = info.turned != 0 ? 0 : rotation_of(*frame, stream);
    info.layout = layout;
  } else if (layout.width != info.layout.width || layout.height != info.layout.height ||
             layout.format != info.layout.format) {
    const auto text = [](const PixelLayout& l) {
      return std::to_string(l.width) + "x" + std::to_string(l.height) + " " + l.format;
    };
    throw Error(ErrorKind::kInput, where.string(),
                "frame " + std::to_string(delivered) + " is " + text(layout) + ", the frames before it are " +
                    text(info.layout),
                "Cut or convert it so that all frames are alike");
  }
  return plain_frame(std::move(frame), info.layout);
}

// Only a frame shows which way it lies.
void VideoReader::Impl::set_up_filters(const AVFrame& frame) {
  looked_at = true;
  AVStream& stream = const_cast<AVStream&>(decoder->stream());
  aspect = av_guess_sample_aspect_ratio(nullptr, &stream, const_cast<AVFrame*>(&frame));
  if (repairs.upright) info.turned = rotation_of(frame, stream);
  repairs.sdr =
      repairs.sdr && (frame.color_trc == AVCOL_TRC_SMPTE2084 || frame.color_trc == AVCOL_TRC_ARIB_STD_B67);
  const std::string tags = repairs.sdr ? missing_hdr_tags(frame) : "";
  Repairs changing = repairs;
  changing.upright = false;
  info.repairs = tags + filter_text(changing);
  if (const std::string text = tags + filter_text(repairs, info.turned); !text.empty())
    graph.emplace(text, frame, stream.time_base, path.string());
}

// The next frame of the file, repaired when that is asked for: repairs look at neighbours, and so come later.
AvOwner<AVFrame> VideoReader::Impl::next_repaired() {
  for (;;) {
    if (graph)
      if (AvOwner<AVFrame> done = graph->pull()) return done;
    if (all_pushed) return nullptr;
    AvOwner<AVFrame> frame = decoder->next();
    all_pushed = frame == nullptr;
    if (!looked_at && frame) set_up_filters(*frame);
    if (!graph) return frame;
    if (frame) {
      // The filters were set up for the first frame's size, and do not look again.
      if (repaired_format.width == 0)
        repaired_format = {frame->width, frame->height, frame->format};
      else if (frame->width != repaired_format.width || frame->height != repaired_format.height ||
               frame->format != repaired_format.format)
        throw Error(ErrorKind::kInput, path.string(),
                    "its frames change from " + std::to_string(repaired_format.width) + "x" +
                        std::to_string(repaired_format.height) + " to " + std::to_string(frame->width) + "x" +
                        std::to_string(frame->height) + " or to another format",
                    "Cut or convert it so that all frames are alike");
      frame->pts = frame->best_effort_timestamp;
    }
    graph->push(frame.get());
  }
}

std::optional<Frame> VideoReader::Impl::decode_file() {
  AvOwner<AVFrame> frame = next_repaired();
  if (!frame) return std::nullopt;
  const std::int64_t pts = graph ? frame->pts : frame->best_effort_timestamp;
  Frame plain = accept(std::move(frame), decoder->stream(), path);
  plain.time_s = time_of(pts, graph ? graph->time_base() : decoder->stream().time_base);
  return plain;
}

std::optional<Frame> VideoReader::Impl::decode_picture() {
  while (next_file < sequence.files.size()) {
    const fs::path& file = sequence.files[next_file];
    const std::int64_t number = sequence.numbers[next_file++];
    std::optional<Decoder> picture;
    AvOwner<AVFrame> frame;
    try {
      picture.emplace(file, DecoderOptions{.picture = true});
      frame = picture->next();
    } catch (const Error&) {  // reported at the end, with all others
    }
    if (!frame) {
      broken_files.push_back(file.filename().string());
      continue;
    }
    if (delivered == 0) info.codec = avcodec_get_name(picture->codec());
    Frame plain = accept(std::move(frame), picture->stream(), file);
    plain.time_s = time_of(number, {static_cast<int>(info.fps_den), static_cast<int>(info.fps_num)});
    return plain;
  }
  return std::nullopt;
}

std::optional<Frame> VideoReader::Impl::decode() {
  std::optional<Frame> frame = decoder ? decode_file() : decode_picture();
  if (frame)
    ++delivered;
  else
    conclude();
  return frame;
}

// What was lost, once nothing more comes.
void VideoReader::Impl::conclude() {
  at_end = true;
  const auto say = [this](const std::string& text) { complaint += (complaint.empty() ? "" : "; ") + text; };
  if (!decoder) {
    const std::int64_t span = sequence.numbers.back() - sequence.numbers.front() + 1;
    const auto files = static_cast<std::int64_t>(sequence.files.size());
    if (span > files)
      say(of(span - files, span) + " numbers are missing between " +
          sequence.files.front().filename().string() + " and " + sequence.files.back().filename().string());
    if (!broken_files.empty())
      say(of(static_cast<std::int64_t>(broken_files.size()), files) +
          " pictures could not be decoded, first " + broken_files.front());
    return;
  }
  // A duration is a weaker claim than a list of frames: only a whole second and a tenth less is reported.
  const double reached_s = last_time_s + frame_s;
  if (info.claimed_frames > delivered)
    say("file is truncated or damaged: " + of(delivered, info.claimed_frames) + " frames");
  else if (info.claimed_frames == 0 && info.claimed_duration_s > 1 &&
           reached_s < 0.9 * info.claimed_duration_s && reached_s < info.claimed_duration_s - 1)
    say("file is truncated or damaged: " + std::to_string(delivered) + " frames reach to " +
        std::to_string(reached_s) + " of " + std::to_string(info.claimed_duration_s) + " s");
  if (decoder->damaged_packets() > 0)
    say(std::to_string(decoder->damaged_packets()) + " packets could not be decoded");
  if (decoder->damaged_frames() > 0)
    say(std::to_string(decoder->damaged_frames()) + " frames were decoded with errors");
  if (!complaint.empty() && !decoder->fault().empty()) complaint += " (" + decoder->fault() + ")";
  if (complaint.empty() && !decoder->fault().empty()) complaint = decoder->fault();
}

VideoReader::VideoReader(const fs::path& path, int threads, const Repairs& repairs)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->repairs = repairs;
  impl_->threads = threads;
  std::error_code fault;
  const bool exists = fs::exists(path, fault);
  if (fs::is_directory(path, fault) || (!exists && is_pattern(path)))
    impl_->open_sequence();
  else
    impl_->open_file();
  impl_->first = impl_->decode();
  if (!impl_->first && impl_->decoder && impl_->decoder->codec() == AV_CODEC_ID_WEBP)
    throw Error(ErrorKind::kInput, path.string(), "animated WebP cannot be decoded by FFmpeg 5.1",
                "Convert it to PNG frames or APNG");
  if (!impl_->first)
    throw Error(ErrorKind::kInput, path.string(),
                "no frame could be decoded" + (impl_->complaint.empty() ? "" : " (" + impl_->complaint + ")"),
                "Copy or download it again, or leave it out");
}

VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader::~VideoReader() = default;

const VideoInfo& VideoReader::info() const { return impl_->info; }

std::optional<Frame> VideoReader::next() {
  if (impl_->first) return std::exchange(impl_->first, std::nullopt);
  if (impl_->at_end) return std::nullopt;
  return impl_->decode();
}

const std::string& VideoReader::complaint() const { return impl_->complaint; }

}  // namespace freshet::media
