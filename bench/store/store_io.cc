// What do the store's tiles cost in bytes and time, beside FFV1 level 3 for the same frames?
//
//   bench_store_io CLIP.. [--frames N] [--json FILE]        CLIP: any video that the ffmpeg program decodes
//
// Frames are decoded by `ffmpeg -f rawvideo`, stored, read back and compared before anything is timed. Then:
// the file's bytes against FFV1's (ffmpeg's defaults and one key frame in 16, four slices), encoding and
// decoding speed of both in CPU time of one thread, and patches of 48 x 48 over all frames, from the page
// cache and after it was dropped.

#include <fcntl.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>

#include "bench/harness/arguments.h"
#include "bench/harness/machine.h"
#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "store/rewrite/rewrite.h"
#include "store/store.h"

namespace {

using namespace freshet;
/// CPU time of the programs that were run and have ended.
double children_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::vector<std::byte> output_of(const std::string& command) {
  std::vector<std::byte> bytes;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw Error(ErrorKind::kIo, command, "cannot be run");
  std::vector<std::byte> buffer(1 << 20);
  for (std::size_t got; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(got));
  }
  if (pclose(pipe) != 0) throw Error(ErrorKind::kInput, command, "failed");
  return bytes;
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

struct Video {
  std::string path, pixel_format;
  std::uint32_t width = 0, height = 0, frames = 0;
  std::vector<store::PlaneShape> planes;
  std::vector<std::byte> bytes;  // frame after frame, planes packed
  std::size_t frame_bytes = 0;
};

Video decode(const std::string& path, int frames) {
  Video video;
  video.path = path;
  const auto text = output_of(
      "ffprobe -v error -select_streams v:0 -show_entries stream=width,height,pix_fmt -of csv=p=0 " +
      quoted(path));
  char format[64] = {};
  const std::string line(reinterpret_cast<const char*>(text.data()), text.size());
  if (std::sscanf(line.c_str(), "%u,%u,%63[a-z0-9]", &video.width, &video.height, format) != 3) {
    throw Error(ErrorKind::kInput, path, "ffprobe says \"" + line + "\"");
  }
  video.pixel_format = format;
  const std::uint32_t w = video.width, h = video.height;
  if (video.pixel_format == "yuv420p") {
    video.planes = {{w, h, 1}, {(w + 1) / 2, (h + 1) / 2, 1}, {(w + 1) / 2, (h + 1) / 2, 1}};
  } else if (video.pixel_format == "yuv422p10le") {
    video.planes = {{w, h, 2}, {(w + 1) / 2, h, 2}, {(w + 1) / 2, h, 2}};
  } else {
    throw Error(ErrorKind::kInput, path,
                "this bench knows yuv420p and yuv422p10le, not " + video.pixel_format);
  }
  for (const auto& plane : video.planes) {
    video.frame_bytes += std::size_t{plane.width} * plane.height * plane.bytes_per_sample;
  }
  video.bytes = output_of(
      fmt::format("ffmpeg -v error -nostdin -noautorotate -i {} -frames:v {} -f rawvideo -pix_fmt {} -",
                  quoted(path), frames, video.pixel_format));
  video.frames = static_cast<std::uint32_t>(video.bytes.size() / video.frame_bytes);
  return video;
}

/// What FFV1 makes of the same frames: level 3, four slices; one thread of the ffmpeg program, CPU seconds
/// with the reading of the raw frames.
struct Ffv1 {
  double bytes = 0, encode_seconds = 0, decode_seconds = 0;
};

Ffv1 ffv1(const Video& video, const std::string& options, const std::filesystem::path& folder) {
  const auto raw = (folder / "frames.yuv").string(), file = (folder / "ffv1.nut").string();
  std::ofstream(raw, std::ios::binary)
      .write(reinterpret_cast<const char*>(video.bytes.data()),
             static_cast<std::streamsize>(video.bytes.size()));
  Ffv1 result;
  double start = children_seconds();
  output_of(fmt::format(
      "ffmpeg -v error -nostdin -y -f rawvideo -pix_fmt {} -s {}x{} -i {} -threads 1 -c:v ffv1 -level 3 "
      "-slices 4 {} -f nut {}",
      video.pixel_format, video.width, video.height, quoted(raw), options, quoted(file)));
  result.encode_seconds = children_seconds() - start;
  result.bytes = static_cast<double>(std::filesystem::file_size(file));
  start = children_seconds();
  output_of(fmt::format("ffmpeg -v error -nostdin -threads 1 -i {} -f null -", quoted(file)));
  result.decode_seconds = children_seconds() - start;
  std::filesystem::remove(raw);
  return result;
}

void add(store::Store& to, const Video& video) {
  store::ClipWriter writer = to.add_clip();
  writer.begin_stream(store::Stream::kFrames, video.planes);
  std::vector<store::PlaneView> views;
  const std::byte* at = video.bytes.data();
  for (std::uint32_t f = 0; f < video.frames; ++f) {
    for (const auto& plane : video.planes) {
      const std::size_t row = std::size_t{plane.width} * plane.bytes_per_sample;
      views.push_back({at, static_cast<std::ptrdiff_t>(row)});
      at += row * plane.height;
    }
  }
  writer.append(store::Stream::kFrames, views);
  store::ClipRecord record;
  record.name = video.path;
  record.source_hash = video.path;
  record.pixel_format = video.pixel_format;
  record.width = video.width;
  record.height = video.height;
  writer.commit(std::move(record));
}

/// Reads all of the clip; seconds. Compares where asked to.
double read_all(const store::Snapshot& snapshot, const Video& video, bool compare) {
  double seconds = 0;
  std::size_t offset = 0;  // of the plane in a frame
  for (std::uint32_t p = 0; p < video.planes.size(); ++p) {
    const auto& plane = video.planes[p];
    const std::size_t bytes = std::size_t{plane.width} * plane.height * plane.bytes_per_sample;
    std::vector<std::byte> out(bytes * video.frames);
    const double start = bench::process_seconds();
    snapshot.read(snapshot.clips()[0], store::Stream::kFrames, p, {0, 0, plane.width, plane.height}, 0,
                  video.frames, out);
    seconds += bench::process_seconds() - start;
    for (std::uint32_t f = 0; compare && f < video.frames; ++f) {
      if (!std::equal(out.begin() + static_cast<std::ptrdiff_t>(f * bytes),
                      out.begin() + static_cast<std::ptrdiff_t>((f + 1) * bytes),
                      video.bytes.begin() + static_cast<std::ptrdiff_t>(f * video.frame_bytes + offset))) {
        throw Error(ErrorKind::kDamaged, video.path,
                    fmt::format("frame {} of plane {} reads back otherwise", f, p));
      }
    }
    offset += bytes;
  }
  return seconds;
}

/// Milliseconds per patch of 48 x 48 luma samples and the chroma that goes with it, over all frames: CPU time
/// from the page cache, where nothing is waited for, and by the clock when cold.
double patch_ms(const std::filesystem::path& file, const Video& video, bool cold, int patches) {
  std::mt19937 random(5);
  std::optional<store::Store> store = store::Store::open_read(file);
  double seconds = 0;
  std::vector<std::byte> out;
  for (int i = 0; i < patches; ++i) {
    if (cold) {
      store.reset();  // mapped pages cannot be dropped
      const int fd = open(file.c_str(), O_RDONLY);
      posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
      close(fd);
      store = store::Store::open_read(file);
    }
    const store::Snapshot snapshot = store->snapshot();
    const std::uint32_t x = static_cast<std::uint32_t>(random()) % (video.width - 47);
    const std::uint32_t y = static_cast<std::uint32_t>(random()) % (video.height - 47);
    const Stopwatch watch;
    const double cpu_start = bench::process_seconds();
    for (std::uint32_t p = 0; p < video.planes.size(); ++p) {
      const auto& plane = video.planes[p];
      const std::uint32_t sx = (video.width + plane.width - 1) / plane.width,
                          sy = (video.height + plane.height - 1) / plane.height;
      const store::Rect region{x / sx, y / sy, 48 / sx, 48 / sy};
      out.resize(std::size_t{region.width} * region.height * plane.bytes_per_sample * video.frames);
      snapshot.read(snapshot.clips()[0], store::Stream::kFrames, p, region, 0, video.frames, out);
    }
    seconds += cold ? watch.seconds() : bench::process_seconds() - cpu_start;
  }
  return 1e3 * seconds / patches;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> clips;
  int frames = 1 << 20;
  std::string json_file;
  bench::Arguments app("What do the store's tiles cost in bytes and time, beside FFV1?");
  app.option("CLIP", clips, "Any video that the ffmpeg program decodes").required();
  app.option("--frames", frames, "The first frames of each clip [all]");
  app.option("--json", json_file, "Write the figures here");
  app.parse(argc, argv);
  std::string name = (std::filesystem::temp_directory_path() / "store_io_XXXXXX").string();
  const std::filesystem::path folder = mkdtemp(name.data());
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  nlohmann::json rows = nlohmann::json::array();
  double raw_sum = 0, store_sum = 0, ffv1_sum = 0, ffv1_16_sum = 0, encode_sum = 0, decode_sum = 0,
         ffv1_encode = 0, ffv1_decode = 0;
  fmt::print("{:<30} {:>10} {:>7} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}\n", "clip", "raw MB",
             "ratio", "of FFV1", "of -g 16", "enc MB/s", "of FFV1", "dec MB/s", "of FFV1", "patch ms",
             "cold ms");
  for (const std::string& path : clips) {
    const Video video = decode(path, frames);
    const auto file = folder / "clip.freshet";
    store::Store store = store::Store::create(file, "");
    const double start = bench::process_seconds();
    add(store, video);
    const double encode = bench::process_seconds() - start;
    read_all(store.snapshot(), video, true);
    const double decode_seconds = read_all(store.snapshot(), video, false);
    store = {};
    const auto stored = static_cast<double>(store::compact(file).after);
    const Ffv1 plain = ffv1(video, "", folder), keyed = ffv1(video, "-g 16", folder);
    const double warm = patch_ms(file, video, false, 20), cold = patch_ms(file, video, true, 20);
    const double raw = static_cast<double>(video.bytes.size());
    fmt::print(
        "{:<30} {:>10.1f} {:>7.2f} {:>9.3f} {:>9.3f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>9.2f} {:>9.2f}\n",
        std::filesystem::path(path).filename().string(), raw / 1e6, raw / stored, stored / plain.bytes,
        stored / keyed.bytes, raw / encode / 1e6, raw / plain.encode_seconds / 1e6,
        raw / decode_seconds / 1e6, raw / plain.decode_seconds / 1e6, warm, cold);
    std::fflush(stdout);
    rows.push_back({{"clip", path},
                    {"frames", video.frames},
                    {"raw_bytes", raw},
                    {"store_bytes", stored},
                    {"ffv1_bytes", plain.bytes},
                    {"ffv1_encode_seconds", plain.encode_seconds},
                    {"ffv1_decode_seconds", plain.decode_seconds},
                    {"ffv1_g16_bytes", keyed.bytes},
                    {"encode_seconds", encode},
                    {"decode_seconds", decode_seconds},
                    {"patch_ms_warm", warm},
                    {"patch_ms_cold", cold}});
    raw_sum += raw, store_sum += stored, ffv1_sum += plain.bytes, ffv1_16_sum += keyed.bytes,
        ffv1_encode += plain.encode_seconds, ffv1_decode += plain.decode_seconds, encode_sum += encode,
        decode_sum += decode_seconds;
    std::filesystem::remove(file);
    std::filesystem::remove(file.string() + "-lock");
  }
  fmt::print("{:<30} {:>10.1f} {:>7.2f} {:>9.3f} {:>9.3f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}\n", "all",
             raw_sum / 1e6, raw_sum / store_sum, store_sum / ffv1_sum, store_sum / ffv1_16_sum,
             raw_sum / encode_sum / 1e6, raw_sum / ffv1_encode / 1e6, raw_sum / decode_sum / 1e6,
             raw_sum / ffv1_decode / 1e6);
  if (!json_file.empty())
    std::ofstream(json_file) << nlohmann::json{{"bench", "store_io"},
                                               {"compiler", __VERSION__},
                                               {"threads", 1},
                                               {"clips", rows}}
                                    .dump(1)
                             << '\n';
  std::filesystem::remove_all(folder);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
