#include "media/picture/openraster.h"

#include <zip.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <pugixml.hpp>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/picture/picture_bounds.h"
#include "media/picture/picture_file.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr const char* kMime = "image/openraster";
constexpr std::int64_t kMaxAllPixels = 2 * kMaxPicturePixels;
constexpr std::uint64_t kMaxXmlBytes = 4u << 20;
// A layer's PNG: at most eight bytes for a pixel, one more for each row, and what it says beside its pixels.
constexpr std::uint64_t kMaxPixelBytes = 9, kMaxOtherBytes = 1u << 20;
constexpr zip_int64_t kMaxParts = 10'000;
constexpr std::size_t kMaxLayers = 1000, kMaxName = 200, kMaxLayerName = 1000;
constexpr int kDeepest = 100;
constexpr int kThumbnail = 256;  // px of its longer side, as the format asks
constexpr const char* kSaveAgain = "Save it again from the program that wrote it";

struct CloseZip {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
struct CloseZipFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
struct FreeSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};
using Zip = std::unique_ptr<zip_t, CloseZip>;

std::string text_of(const zip_error_t& error) {
  zip_error_t copy = error;  // libzip writes its text into it
  copy.str = nullptr;
  std::string text = zip_error_strerror(&copy);
  zip_error_fini(&copy);
  return text;
}

/// The parts of a file that is open.
class Archive {
 public:
  explicit Archive(const fs::path& path) : path_(path), bytes_(read_bytes(path)) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_buffer_create(bytes_.data(), bytes_.size(), 0, &error);
    zip_.reset(source != nullptr ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr);
    if (!zip_) {
      if (source != nullptr) zip_source_free(source);
      refuse(fmt::format("not a whole zip archive ({})", text_of(error)),
             "It may have been cut short. " + std::string(kSaveAgain));
    }
    if (const zip_int64_t parts = zip_get_num_entries(zip_.get(), 0); parts > kMaxParts)
      refuse(fmt::format("it has {} parts, at most {} are expected", parts, kMaxParts), kSaveAgain);
  }

  [[noreturn]] void refuse(const std::string& fault, const std::string& remedy) const {
    throw Error(ErrorKind::kInput, path_.string(), fault, remedy);
  }

  const fs::path& path() const { return path_; }

  /// What a part begins with, at most so many bytes; nothing where there is none.
  std::optional<Bytes> beginning(const std::string& name, std::size_t most) const {
    const std::optional<Entry> entry = find(name);
    if (!entry) return std::nullopt;
    Bytes bytes(most);
    const zip_int64_t got = zip_fread(entry->file.get(), bytes.data(), bytes.size());
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

  /// All of a part; nothing where there is none. Throws where it is longer than it may be, or than it says.
  std::optional<Bytes> part(const std::string& name, std::uint64_t most) const {
    const std::optional<Entry> entry = find(name);
    if (!entry) return std::nullopt;
    if (entry->size > most)
      refuse(fmt::format("{} in it says that it unpacks to {} bytes, at most {} are expected", name,
                         entry->size, most),
             kSaveAgain);
    // In steps, so that a wrong size allocates no more than is there; a byte more than it says is too much.
    constexpr std::size_t kStep = 1u << 20;
    Bytes bytes;
    while (true) {
      const std::size_t done = bytes.size();
      bytes.resize(std::min<std::size_t>(done + kStep, entry->size + 1));
      const zip_int64_t got = zip_fread(entry->file.get(), bytes.data() + done, bytes.size() - done);
      if (got < 0)
        refuse(fmt::format("{} in it is damaged ({})", name, text_of(*zip_file_get_error(entry->file.get()))),
               kSaveAgain);
      bytes.resize(done + static_cast<std::size_t>(got));
      if (got == 0) break;
      if (bytes.size() > entry->size) refuse(name + " in it unpacks to more than it says", kSaveAgain);
    }
    if (bytes.size() != entry->size) refuse(name + " in it unpacks to less than it says", kSaveAgain);
    return bytes;
  }

 private:
  struct Entry {
    std::uint64_t size = 0;  // unpacked, as the archive says
    std::unique_ptr<zip_file_t, CloseZipFile> file;
  };
  std::optional<Entry> find(const std::string& name) const {
    const zip_int64_t index = zip_name_locate(zip_.get(), name.c_str(), 0);
    if (index < 0) return std::nullopt;
    zip_stat_t stat;
    if (zip_stat_index(zip_.get(), static_cast<zip_uint64_t>(index), 0, &stat) != 0 ||
        (stat.valid & ZIP_STAT_SIZE) == 0)
      refuse(name + " in it is damaged", kSaveAgain);
    Entry entry;
    entry.size = stat.size;
    entry.file.reset(zip_fopen_index(zip_.get(), static_cast<zip_uint64_t>(index), 0));
    if (!entry.file)
      refuse(fmt::format("{} in it cannot be read ({})", name, zip_strerror(zip_.get())), kSaveAgain);
    return entry;
  }

  fs::path path_;
  Bytes bytes_;
  Zip zip_;
};

// A whole attribute as a number. otherwise   where there is none.
double number(const Archive& archive, const pugi::xml_node& node, const char* name, double otherwise) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute || *attribute.value() == '\0') return otherwise;
  std::string_view text = attribute.value();
  double value = 0;
  std::size_t used = 0;
  try {
    value = std::stod(std::string(text.substr(0, 40)), &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !std::isfinite(value) || std::abs(value) > 1e9)
    archive.refuse(fmt::format("stack.xml: {} of a {} is \"{}\", not a number", name, node.name(),
                               text.substr(0, kMaxName)),
                   kSaveAgain);
  return value;
}

// What a layer inherits from the groups that it lies in.
struct Group {
  float opacity = 1;
  bool visible = true;
};

class Reader {
 public:
  explicit Reader(const fs::path& path) : archive_(path) {}

  OpenRaster read() {
    const std::optional<Bytes> mime = archive_.part("mimetype", 1024);
    if (!mime)
      archive_.refuse("a zip archive without a mimetype: no OpenRaster", "Save it as OpenRaster (.ora)");
    std::string said(mime->begin(), mime->end());
    while (!said.empty() && std::strchr("\r\n\t ", said.back()) != nullptr) said.pop_back();
    if (said != kMime)
      archive_.refuse(fmt::format("its mimetype is \"{}\", not {}", said.substr(0, kMaxName), kMime),
                      "Save it as OpenRaster (.ora)");
    const std::optional<Bytes> text = archive_.part("stack.xml", kMaxXmlBytes);
    if (!text) archive_.refuse("stack.xml, which lists the layers, is missing", kSaveAgain);
    pugi::xml_document xml;
    const pugi::xml_parse_result parsed = xml.load_buffer(text->data(), text->size());
    if (!parsed)
      archive_.refuse(
          fmt::format("stack.xml is not whole: {}, at byte {}", parsed.description(), parsed.offset),
          kSaveAgain);
    const pugi::xml_node image = xml.child("image");
    const pugi::xml_node stack = image.child("stack");
    if (!stack) archive_.refuse("stack.xml has no stack of layers", kSaveAgain);
    const double width = number(archive_, image, "w", 0), height = number(archive_, image, "h", 0);
    if (width < 1 || height < 1 || width * height > static_cast<double>(kMaxPicturePixels))
      archive_.refuse(fmt::format("its canvas is {} x {} px, 1 to 2^28 in all are expected", width, height),
                      "Give the image w and h, or reduce it");
    out_.canvas = cv::Size(static_cast<int>(width), static_cast<int>(height));
    walk(stack, {}, 0);
    if (out_.layers.empty()) archive_.refuse("it has no layers", "Paint one");
    return std::move(out_);
  }

 private:
  void walk(const pugi::xml_node& stack, const Group& group, int depth) {
    if (depth > kDeepest)
      archive_.refuse(fmt::format("stack.xml: groups lie in each other more than {} deep", kDeepest),
                      "Flatten some");
    for (const pugi::xml_node& node : stack.children()) {
      if (node.type() != pugi::node_element) continue;
      const std::string_view kind = node.name();
      Group own = group;
      own.opacity *= static_cast<float>(std::clamp(number(archive_, node, "opacity", 1), 0.0, 1.0));
      own.visible = own.visible && std::string_view(node.attribute("visibility").value()) != "hidden";
      if (kind == "stack")
        walk(node, own, depth + 1);
      else if (kind == "layer")
        add_layer(node, own);
      else
        out_.notices.push_back(
            fmt::format("a {} in it is left out: it has no paint", kind.substr(0, kMaxName)));
    }
  }

  void add_layer(const pugi::xml_node& node, const Group& group) {
    if (out_.layers.size() == kMaxLayers)
      archive_.refuse(fmt::format("it has more than {} layers", kMaxLayers), "Merge some");
    RasterLayer layer{.name = node.attribute("name").value(), .pixels = {}, .at = {}};
    if (layer.name.size() > kMaxLayerName)
      archive_.refuse(fmt::format("a layer's name has {} bytes, at most {} are expected", layer.name.size(),
                                  kMaxLayerName),
                      "Give it a shorter name");
    layer.opacity = group.opacity;
    layer.visible = group.visible;
    const std::string called = "layer \"" + layer.name.substr(0, kMaxName) + "\"";
    if (const char* composite = node.attribute("composite-op").value(); *composite != '\0')
      layer.composite = std::string(composite).substr(0, kMaxName);
    if (layer.composite != "svg:src-over")
      out_.notices.push_back(fmt::format(
          "{} is composited by {}, and is taken as if it lay over what is below", called, layer.composite));
    layer.at = {cvRound(number(archive_, node, "x", 0)), cvRound(number(archive_, node, "y", 0))};
    const std::string source = node.attribute("src").value();
    // A name is only looked up in the archive, and never on the disk; one that would lead out of it is none of a
    // painting program's.
    if (source.empty() || source.front() == '/' || source.find('\\') != std::string::npos ||
        ("/" + source + "/").find("/../") != std::string::npos)
      archive_.refuse(fmt::format("{}: its source \"{}\" is no name inside of the file", called,
                                  source.substr(0, kMaxName)),
                      kSaveAgain);
    const std::string what = called + ": " + source.substr(0, kMaxName);
    const std::optional<Bytes> header = archive_.beginning(source, 64);
    if (!header)
      archive_.refuse(fmt::format("{}: its picture {} is missing", called, source.substr(0, kMaxName)),
                      kSaveAgain);
    const auto pixels = static_cast<std::uint64_t>(pixels_of(*header, what));
    layer.pixels = decode(archive_.part(source, kMaxPixelBytes * pixels + kMaxOtherBytes).value(), what);
    out_.layers.push_back(std::move(layer));
  }

  std::int64_t pixels_of(const Bytes& png, const std::string& what) {
    const cv::Size size = claimed_size(png).value_or(cv::Size());
    if (size.empty() || png[0] != 0x89)
      archive_.refuse(what + " is no PNG", "Save raster layers alone, as OpenRaster");
    const std::int64_t pixels = std::int64_t{size.width} * size.height;
    if (pixels > kMaxPicturePixels || (pixels_ += pixels) > kMaxAllPixels)
      archive_.refuse(fmt::format("{} is {} x {} px: too large, alone or with those before it", what,
                                  size.width, size.height),
                      "Reduce it: 2^28 px in a layer, 2^29 in all");
    return pixels;
  }

  cv::Mat decode(const Bytes& png, const std::string& what) {
    // OpenCV fills what a cut PNG lacks, and says so on stderr alone.
    if (png.size() < 12 || std::memcmp(png.data() + png.size() - 8, "IEND", 4) != 0)
      archive_.refuse(what + " is cut short", kSaveAgain);
    cv::Mat pixels_read;
    try {
      pixels_read =
          cv::imdecode(bounded_picture(png, archive_.path().string() + ": " + what), cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
    }
    if (pixels_read.empty() || (pixels_read.depth() != CV_8U && pixels_read.depth() != CV_16U))
      archive_.refuse(what + " cannot be decoded", kSaveAgain);
    if (pixels_read.channels() == 1) cv::cvtColor(pixels_read, pixels_read, cv::COLOR_GRAY2BGRA);
    if (pixels_read.channels() == 3) cv::cvtColor(pixels_read, pixels_read, cv::COLOR_BGR2BGRA);
    return pixels_read;
  }

  Archive archive_;
  OpenRaster out_;
  std::int64_t pixels_ = 0;
};

/// Parts in the order in which they are added.
class ArchiveWriter {
 public:
  explicit ArchiveWriter(const fs::path& path) : path_(path) {
    zip_error_t error;
    zip_error_init(&error);
    source_.reset(zip_source_buffer_create(nullptr, 0, 0, &error));
    if (source_) zip_.reset(zip_open_from_source(source_.get(), ZIP_TRUNCATE, &error));
    if (!zip_) fail(text_of(error));
    zip_source_keep(source_.get());  // the archive has taken the one that there was
  }

  /// Stored as it is: PNG is packed already, and the mimetype must be readable.
  void add(const std::string& name, Bytes bytes, bool pack = false) {
    parts_.push_back(std::make_unique<Bytes>(std::move(bytes)));
    zip_source_t* part = zip_source_buffer(zip_.get(), parts_.back()->data(), parts_.back()->size(), 0);
    const zip_int64_t index =
        part != nullptr ? zip_file_add(zip_.get(), name.c_str(), part, ZIP_FL_ENC_GUESS) : -1;
    if (index < 0) {
      if (part != nullptr) zip_source_free(part);
      fail(zip_strerror(zip_.get()));
    }
    const auto at = static_cast<zip_uint64_t>(index);
    zip_set_file_compression(zip_.get(), at, pack ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
    zip_file_set_dostime(zip_.get(), at, 0, 33, 0);  // 1980-01-01: the same layers, the same bytes
  }

  Bytes finish() {
    if (zip_close(zip_.get()) != 0) fail(zip_strerror(zip_.get()));
    zip_.release();
    zip_stat_t stat;
    if (zip_source_stat(source_.get(), &stat) != 0 || zip_source_open(source_.get()) != 0)
      fail("it cannot be read back");
    Bytes bytes(stat.size);
    const zip_int64_t got = zip_source_read(source_.get(), bytes.data(), bytes.size());
    zip_source_close(source_.get());
    if (got < 0 || static_cast<std::size_t>(got) != bytes.size()) fail("it cannot be read back");
    return bytes;
  }

 private:
  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::kIo, path_.string(), "libzip cannot make it (" + fault + ")");
  }
  fs::path path_;
  std::vector<std::unique_ptr<Bytes>> parts_;  // borrowed by the archive
  std::unique_ptr<zip_source_t, FreeSource> source_;
  Zip zip_;
};

// The smallest part that holds all that is not transparent; a pixel where nothing is.
cv::Rect opaque_part(const cv::Mat& pixels) {
  cv::Mat alpha;
  cv::extractChannel(pixels, alpha, 3);
  const cv::Rect part = cv::boundingRect(alpha > 0);
  return part.empty() ? cv::Rect(0, 0, 1, 1) : part;
}

Bytes png_of(const fs::path& path, const cv::Mat& pixels) {
  return encode_picture(path.parent_path() / (path.stem().string() + ".png"), pixels);
}

std::string xml_of(const OpenRaster& raster, const std::vector<cv::Point>& corners) {
  pugi::xml_document xml;
  pugi::xml_node image = xml.append_child("image");
  image.append_attribute("version") = "0.0.3";
  image.append_attribute("w") = raster.canvas.width;
  image.append_attribute("h") = raster.canvas.height;
  image.append_attribute("xres") = 72;
  image.append_attribute("yres") = 72;
  pugi::xml_node stack = image.append_child("stack");
  for (std::size_t i = 0; i < raster.layers.size(); ++i) {
    const RasterLayer& layer = raster.layers[i];
    pugi::xml_node node = stack.append_child("layer");
    node.append_attribute("name") = layer.name.c_str();
    node.append_attribute("src") = fmt::format("data/layer{:03}.png", i).c_str();
    node.append_attribute("x") = corners[i].x;
    node.append_attribute("y") = corners[i].y;
    node.append_attribute("opacity") = fmt::format("{:.6g}", layer.opacity).c_str();
    node.append_attribute("visibility") = layer.visible ? "visible" : "hidden";
    node.append_attribute("composite-op") = layer.composite.c_str();
  }
  struct ToText : pugi::xml_writer {
    std::string text;
    void write(const void* data, std::size_t size) override {
      text.append(static_cast<const char*>(data), size);
    }
  } to;
  xml.save(to, " ");
  return to.text;
}

void check_written(const fs::path& path, const OpenRaster& raster) {
  const auto refuse = [&](const std::string& fault) { throw Error(ErrorKind::kUsage, path.string(), fault); };
  if (raster.canvas.empty() || raster.layers.empty()) refuse("an OpenRaster has a canvas and layers");
  for (const RasterLayer& layer : raster.layers)
    if (layer.pixels.empty() || (layer.pixels.type() != CV_8UC4 && layer.pixels.type() != CV_16UC4))
      refuse("layer \"" + layer.name + "\": 4 channels of 8 or 16 bits are written");
}

}  // namespace

bool looks_like_openraster(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending == ".ora";
}

OpenRaster read_openraster(const fs::path& path) { return Reader(path).read(); }

cv::Mat on_canvas(const RasterLayer& layer, cv::Size canvas) {
  cv::Mat out = cv::Mat::zeros(canvas, layer.pixels.type());
  // In 64 bits: a hostile corner plus a width passes those of an int.
  const std::int64_t left = layer.at.x, top = layer.at.y;
  const std::int64_t x0 = std::max<std::int64_t>(0, left), y0 = std::max<std::int64_t>(0, top);
  const std::int64_t x1 = std::min<std::int64_t>(canvas.width, left + layer.pixels.cols),
                     y1 = std::min<std::int64_t>(canvas.height, top + layer.pixels.rows);
  if (x0 >= x1 || y0 >= y1) return out;
  const cv::Rect to(static_cast<int>(x0), static_cast<int>(y0), static_cast<int>(x1 - x0),
                    static_cast<int>(y1 - y0));
  const cv::Rect from(static_cast<int>(x0 - left), static_cast<int>(y0 - top), to.width, to.height);
  layer.pixels(from).copyTo(out(to));
  if (layer.opacity >= 1) return out;
  cv::Mat alpha;
  cv::extractChannel(out, alpha, 3);
  alpha.convertTo(alpha, -1, layer.opacity);
  cv::insertChannel(alpha, out, 3);
  return out;
}

cv::Mat merged(const OpenRaster& raster) {
  cv::Mat colour = cv::Mat::zeros(raster.canvas, CV_32FC3), cover = cv::Mat::zeros(raster.canvas, CV_32F);
  for (auto layer = raster.layers.rbegin(); layer != raster.layers.rend(); ++layer) {
    if (!layer->visible) continue;
    cv::Mat pixels;
    const cv::Mat placed = on_canvas(*layer, raster.canvas);
    placed.convertTo(pixels, CV_32F, placed.depth() == CV_8U ? 1.0 / 255 : 1.0 / 65535);
    for (int y = 0; y < pixels.rows; ++y)
      for (int x = 0; x < pixels.cols; ++x) {
        const cv::Vec4f p = pixels.at<cv::Vec4f>(y, x);
        cv::Vec3f& under = colour.at<cv::Vec3f>(y, x);
        under = cv::Vec3f(p[0], p[1], p[2]) * p[3] + under * (1 - p[3]);
        float& a = cover.at<float>(y, x);
        a = p[3] + a * (1 - p[3]);
      }
  }
  cv::Mat out(raster.canvas, CV_16UC4);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const float a = cover.at<float>(y, x);
      const cv::Vec3f c = a > 0 ? colour.at<cv::Vec3f>(y, x) * (65535 / a) : cv::Vec3f(0, 0, 0);
      out.at<cv::Vec4w>(y, x) = {
          cv::saturate_cast<std::uint16_t>(c[0]), cv::saturate_cast<std::uint16_t>(c[1]),
          cv::saturate_cast<std::uint16_t>(c[2]), cv::saturate_cast<std::uint16_t>(65535 * a)};
    }
  return out;
}

void write_openraster(const fs::path& path, const OpenRaster& raster) {
  require_folder_of(path);
  check_written(path, raster);
  ArchiveWriter archive(path);
  archive.add("mimetype", Bytes(kMime, kMime + std::strlen(kMime)));
  std::vector<cv::Point> corners;
  std::vector<cv::Rect> parts;
  bool deep = false;
  for (const RasterLayer& layer : raster.layers) {
    parts.push_back(opaque_part(layer.pixels));
    corners.push_back(layer.at + parts.back().tl());
    deep = deep || layer.pixels.depth() == CV_16U;
  }
  const std::string xml = xml_of(raster, corners);
  archive.add("stack.xml", Bytes(xml.begin(), xml.end()), true);
  for (std::size_t i = 0; i < raster.layers.size(); ++i)
    archive.add(fmt::format("data/layer{:03}.png", i), png_of(path, raster.layers[i].pixels(parts[i])));
  cv::Mat whole = merged(raster), small;
  cv::Mat bytes;
  whole.convertTo(bytes, CV_8U, 1.0 / 257);
  archive.add("mergedimage.png", png_of(path, deep ? whole : bytes));
  const double scale = std::min(1.0, static_cast<double>(kThumbnail) / std::max(whole.cols, whole.rows));
  cv::resize(bytes, small,
             {std::max(1, cvRound(whole.cols * scale)), std::max(1, cvRound(whole.rows * scale))}, 0, 0,
             cv::INTER_AREA);
  archive.add("Thumbnails/thumbnail.png", png_of(path, small));
  write_bytes(path, archive.finish());
}

}  // namespace freshet::media
