#include "media/frame/decoder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

extern "C" {
#include <libavutil/avstring.h>
#include <libavutil/cpu.h>
}

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/frame/plain_frame.h"
#include "media/frame/png_chunks.h"
#include "platform/open_remedy.h"

namespace freshet::media {
namespace {

constexpr int kWindow = 1 << 16;                            // bytes read ahead
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;  // 8192 x 8192; a hostile header asks for more
constexpr int kMaxThreads = 16;                             // FFmpeg's own limit for frame threads
constexpr int kMaxFaultsInARow = 1000;                      // then the rest of the file is noise

// Files that FFmpeg would draw as text art are not videos to anybody here.
bool draws_text(AVCodecID codec) {
  return codec == AV_CODEC_ID_ANSI || codec == AV_CODEC_ID_BINTEXT || codec == AV_CODEC_ID_XBIN ||
         codec == AV_CODEC_ID_IDF;
}

int refuse_other_files(AVFormatContext*, AVIOContext**, const char*, int, AVDictionary**) {
  return AVERROR(EPERM);
}

// VP8 and VP9 keep alpha as a second picture beside the first, which only libvpx puts together.
const AVCodec* decoder_for(const AVStream& stream) {
  const AVCodecID id = stream.codecpar->codec_id;
  const AVDictionaryEntry* alpha = av_dict_get(stream.metadata, "alpha_mode", nullptr, 0);
  if (alpha && std::strcmp(alpha->value, "0") != 0 && (id == AV_CODEC_ID_VP8 || id == AV_CODEC_ID_VP9))
    if (const AVCodec* libvpx = avcodec_find_decoder_by_name(id == AV_CODEC_ID_VP8 ? "libvpx" : "libvpx-vp9"))
      return libvpx;
  return avcodec_find_decoder(id);
}

// What one of FFmpeg's functions on a film answers. Some pass over what there is no memory for without a word, as its
// reader of Matroska does with a packet; but where an allocation fails, the C library leaves ENOMEM behind. It leaves
// it as well where it finds the memory elsewhere: a picture's functions pass over nothing, and are believed.
template <class Function>
int observed(bool picture, const Function& function) {
  errno = 0;
  const int code = function();
  return !picture && errno == ENOMEM ? AVERROR(ENOMEM) : code;
}

}  // namespace

namespace {

// Formats whose files hold what they show. Others are lists of what to fetch (concat, HLS, DASH), or calls to
// listen on the network (SDP): FFmpeg knows them by their first bytes, whatever the file's name.
constexpr const char* kOwnFormats =
    "mov,matroska,avi,mpeg,mpegvideo,mpegts,asf,flv,ogg,mxf,dv,yuv4mpegpipe,gif,apng,ivf,nut,h264,hevc,m4v,"
    "mjpeg,obu,av1,vc1,wav,mp3,flac,aac,"
    "png_pipe,jpeg_pipe,bmp_pipe,webp_pipe,tiff_pipe";

bool own_format(const AVInputFormat& format) { return av_match_list(format.name, kOwnFormats, ',') > 0; }

}  // namespace

void require_file(const std::filesystem::path& path) {
  std::error_code fault;
  const std::filesystem::file_status status = std::filesystem::status(path, fault);
  if (!std::filesystem::exists(status))
    throw Error(ErrorKind::kInput, path.string(), "there is no such file", "Check the name");
  if (!std::filesystem::is_regular_file(status))
    throw Error(ErrorKind::kInput, path.string(), "is not a regular file", "Name a file");
  if (std::filesystem::file_size(path, fault) == 0)
    throw Error(ErrorKind::kInput, path.string(), "the file is empty", "Copy or download it again");
}

struct Decoder::File {
  int descriptor = -1;
  int fault = 0;  // errno of a read that the machine refused
  AVIOContext* window = nullptr;

  explicit File(const std::filesystem::path& path) : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor < 0)
      throw Error(ErrorKind::kInput, path.string(), std::strerror(errno),
                  open_remedy(errno, "Check its permissions"));
    auto* buffer = static_cast<unsigned char*>(av_malloc(kWindow));
    window = buffer ? avio_alloc_context(buffer, kWindow, 0, this, read, nullptr, seek) : nullptr;
    if (!window) {
      av_free(buffer);
      ::close(descriptor);
      throw std::bad_alloc();
    }
  }
  ~File() {
    av_freep(&window->buffer);
    avio_context_free(&window);
    ::close(descriptor);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  static int read(void* opaque, std::uint8_t* to, int bytes) {
    auto* const file = static_cast<File*>(opaque);
    for (;;) {
      const ssize_t got = ::read(file->descriptor, to, static_cast<std::size_t>(bytes));
      if (got > 0) return static_cast<int>(got);
      if (got == 0) return AVERROR_EOF;
      if (errno == EINTR) continue;
      file->fault = errno;
      return AVERROR(errno);
    }
  }
  static std::int64_t seek(void* opaque, std::int64_t offset, int whence) {
    const int from = static_cast<File*>(opaque)->descriptor;
    struct stat status {};
    if (whence == AVSEEK_SIZE) return fstat(from, &status) == 0 ? status.st_size : AVERROR(errno);
    const off_t at = lseek(from, offset, whence & ~AVSEEK_FORCE);
    return at < 0 ? AVERROR(errno) : at;
  }
};

Decoder::Decoder(const std::filesystem::path& path, const DecoderOptions& options)
    : name_(path.string()), picture_(options.picture) {
  quiet_libav();
  require_file(path);
  file_ = std::make_shared<File>(path);
  packet_ = new_packet();
  open_container();
  open_codec(options);
}

void Decoder::open_container() {
  AVFormatContext* container = avformat_alloc_context();
  if (!container) throw std::bad_alloc();
  container->pb = file_->window;
  container->io_open = refuse_other_files;
  container->flags |= AVFMT_FLAG_CUSTOM_IO;
  // The ending helps to recognise streams without a header (raw H.264). The rest of the name is kept back,
  // or FFmpeg would take a % in it for a sequence; so is a picture's ending, for the content tells.
  const std::filesystem::path path(name_);
  const std::string hint = !picture_ && looks_like_video(path) ? "video" + path.extension().string() : "";
  const AVInputFormat* format = nullptr;
  int code = av_probe_input_buffer2(container->pb, &format, hint.c_str(), nullptr, 0, 0);
  if (code >= 0 && file_->fault == 0 && !own_format(*format)) {
    avformat_free_context(container);
    throw Error(ErrorKind::kInput, name_,
                std::string("is of a format (") + (format->long_name ? format->long_name : format->name) +
                    ") that clips and pictures are not read from",
                "Convert it with ffmpeg, or leave it out");
  }
  // Whatever a file of an allowed format asks for inside, nothing else is opened.
  container->protocol_whitelist = av_strdup("file");
  container->format_whitelist = av_strdup(kOwnFormats);
  int opened = code;
  if (code >= 0)
    code = observed(picture_,
                    [&] { return opened = avformat_open_input(&container, hint.c_str(), format, nullptr); });
  else
    avformat_free_context(container);
  if (opened >= 0) container_.reset(container);  // else it has been freed
  refuse_if_machine_failed(code);
  if (code < 0)
    throw Error(ErrorKind::kInput, name_, "not a video that FFmpeg can read (" + libav_fault(code) + ")",
                "Convert it with ffmpeg, or leave it out");
  for (unsigned i = 0; i < container->nb_streams; ++i) keep_pixel_chunks(*container->streams[i]->codecpar);
  // It opens decoders of its own.
  std::vector<AVDictionary*> limits(container->nb_streams);
  for (AVDictionary*& limit : limits) av_dict_set_int(&limit, "max_pixels", kMaxPixels, 0);
  code = picture_ ? 0 : observed(false, [&] { return avformat_find_stream_info(container, limits.data()); });
  for (AVDictionary*& limit : limits) av_dict_free(&limit);
  if (code < 0) note(code);
  refuse_if_machine_failed(code);

  bool sound = false;
  for (unsigned i = 0; i < container->nb_streams; ++i) {
    AVStream* stream = container->streams[i];
    sound |= stream->codecpar->codec_type == AVMEDIA_TYPE_AUDIO;
    const bool video = stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
                       !(stream->disposition & AV_DISPOSITION_ATTACHED_PIC) &&
                       !draws_text(stream->codecpar->codec_id);
    if (video && !stream_)
      stream_ = stream;
    else
      stream->discard = AVDISCARD_ALL;
  }
  if (!stream_)
    throw Error(ErrorKind::kInput, name_,
                sound ? "holds sound but no video stream" : "not a video: no video stream was found in it",
                "Leave it out");
}

// What an APNG's file begins with, before its first frame is decoded to learn of its format.
void Decoder::keep_pixel_chunks(AVCodecParameters& parameters) const {
  if (parameters.codec_id != AV_CODEC_ID_APNG || parameters.extradata_size <= 0) return;
  const std::vector<std::uint8_t> kept =
      pixel_chunks({parameters.extradata, static_cast<std::size_t>(parameters.extradata_size)}, name_);
  std::copy(kept.begin(), kept.end(), parameters.extradata);
  std::fill(parameters.extradata + kept.size(), parameters.extradata + parameters.extradata_size, 0);
  parameters.extradata_size = static_cast<int>(kept.size());
}

// The decoder's packet, of a PNG without what its pixels do not need.
int Decoder::send_packet() {
  if (codec() != AV_CODEC_ID_PNG) return avcodec_send_packet(context_.get(), packet_.get());
  const std::vector<std::uint8_t> kept =
      pixel_chunks({packet_->data, static_cast<std::size_t>(packet_->size)}, name_);
  if (kept.size() == static_cast<std::size_t>(packet_->size))
    return avcodec_send_packet(context_.get(), packet_.get());
  const AvOwner<AVPacket> smaller = new_packet();
  if (av_new_packet(smaller.get(), static_cast<int>(kept.size())) < 0 ||
      av_packet_copy_props(smaller.get(), packet_.get()) < 0)
    throw std::bad_alloc();
  std::copy(kept.begin(), kept.end(), smaller->data);
  return avcodec_send_packet(context_.get(), smaller.get());
}

void Decoder::open_codec(const DecoderOptions& options) {
  const AVCodec* codec = decoder_for(*stream_);
  if (!codec)
    throw Error(ErrorKind::kInput, name_,
                std::string("no decoder for its codec ") + avcodec_get_name(stream_->codecpar->codec_id),
                "Convert it to H.264 or FFV1 with ffmpeg");
  context_.reset(avcodec_alloc_context3(codec));
  if (!context_) throw std::bad_alloc();
  int code = avcodec_parameters_to_context(context_.get(), stream_->codecpar);
  context_->pkt_timebase = stream_->time_base;
  context_->flags |= AV_CODEC_FLAG_BITEXACT;
  context_->max_pixels = options.strict ? kMaxPicturePixels : kMaxPixels;
  if (options.strict)
    context_->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
  const int threads = options.threads > 0 ? options.threads : av_cpu_count();
  context_->thread_count = picture_ ? 1 : std::clamp(threads, 1, kMaxThreads);
  if (code >= 0) code = avcodec_open2(context_.get(), codec, nullptr);
  refuse_if_machine_failed(code);
  if (code < 0)
    throw Error(ErrorKind::kInput, name_,
                std::string("its ") + codec->name + " stream cannot be opened (" + libav_fault(code) + ")",
                "Convert it to H.264 or FFV1 with ffmpeg");
}

void Decoder::note(int code) {
  if (fault_.empty()) fault_ = libav_fault(code);
}

// What the machine does not give is not the file's damage: without it, other frames would be taken for the file's own.
void Decoder::refuse_if_machine_failed(int code) const {
  if (file_->fault != 0)
    throw Error(ErrorKind::kInput, name_, std::string("could not be read: ") + std::strerror(file_->fault),
                "Check the disk, and try again");
  if (code == AVERROR(ENOMEM))
    throw Error(ErrorKind::kInput, name_, "there was not the memory that it asks for",
                "End other programs, and try again");
}

int Decoder::read_packet() {
  const int code = observed(picture_, [&] { return av_read_frame(container_.get(), packet_.get()); });
  refuse_if_machine_failed(code);
  return code;
}

// One packet of our stream into the decoder, or the end mark.
void Decoder::feed() {
  for (;;) {
    const int code = read_packet();
    if (code < 0) {
      if (code != AVERROR_EOF) {
        note(code);
        if (++faults_in_a_row_ < kMaxFaultsInARow && code == AVERROR(EAGAIN)) continue;
      }
      drained_ = true;
      avcodec_send_packet(context_.get(), nullptr);
      return;
    }
    const bool ours = packet_->stream_index == stream_->index;
    const int sent = ours ? observed(picture_, [&] { return send_packet(); }) : 0;
    av_packet_unref(packet_.get());
    if (!ours) continue;
    refuse_if_machine_failed(sent);
    if (sent < 0) {
      note(sent);
      ++damaged_packets_;
      ++faults_in_a_row_;
    }
    return;
  }
}

AvOwner<AVFrame> Decoder::next() {
  AvOwner<AVFrame> frame = new_frame();
  for (;;) {
    const int code = observed(picture_, [&] { return avcodec_receive_frame(context_.get(), frame.get()); });
    if (code >= 0) {
      faults_in_a_row_ = 0;
      if (frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT)) ++damaged_frames_;
      return frame;
    }
    if (code == AVERROR_EOF) return nullptr;
    if (code != AVERROR(EAGAIN)) {
      refuse_if_machine_failed(code);
      note(code);
      ++damaged_packets_;
      ++faults_in_a_row_;
    }
    if (faults_in_a_row_ >= kMaxFaultsInARow) return nullptr;
    if (!drained_)
      feed();
    else if (code == AVERROR(EAGAIN))
      return nullptr;
  }
}

std::vector<std::int64_t> Decoder::packet_stamps() {
  std::vector<std::int64_t> stamps;
  drained_ = true;
  for (;;) {
    const int code = read_packet();
    if (code < 0) break;
    const bool shown = packet_->stream_index == stream_->index && (packet_->flags & AV_PKT_FLAG_DISCARD) == 0;
    if (shown && packet_->pts != AV_NOPTS_VALUE) stamps.push_back(packet_->pts);
    av_packet_unref(packet_.get());
  }
  return stamps;
}

std::int64_t Decoder::listed_frames() const {
  if (stream_->nb_frames <= 0) return 0;  // a fragmented MP4 lists its frames only as it goes
  if (!std::strstr(container_->iformat->name, "mp4")) return stream_->nb_frames;
  // MP4 lists each frame, and FFmpeg has already marked those that an edit list hides.
  std::int64_t shown = 0;
  const int entries = avformat_index_get_entries_count(stream_);
  for (int i = 0; i < entries; ++i)
    if (!(avformat_index_get_entry(stream_, i)->flags & AVINDEX_DISCARD_FRAME)) ++shown;
  return shown;
}

}  // namespace freshet::media
