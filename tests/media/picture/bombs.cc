#include "tests/media/picture/bombs.h"

#include <zip.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>

namespace freshet::media {
namespace {

constexpr std::size_t kMega = 1u << 20;

std::string number(std::uint64_t value, int bytes, bool big) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * (big ? bytes - 1 - i : i));
  return text;
}
std::string big(std::uint64_t value, int bytes = 4) { return number(value, bytes, true); }
std::string little(std::uint64_t value, int bytes = 4) { return number(value, bytes, false); }

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  all.reserve(text.size() * times);
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

std::string packed(const std::string& plain) {
  uLongf size = compressBound(plain.size());
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
           plain.size());
  out.resize(size);
  return out;
}

/// A whole zlib stream of that many zeros, a thousandth as long.
std::string packed_zeros(std::size_t megas) {
  static const std::string one = [] {
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);
    std::string plain(kMega, '\0'), out(kMega, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(plain.data());
    stream.avail_in = kMega;
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = kMega;
    deflate(&stream, Z_FULL_FLUSH);  // so that it may be repeated
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
  }();
  const std::uint64_t sum = (megas * kMega % 65521) << 16 | 1;  // Adler-32 of zeros
  return "\x78\xda" + repeated(one, megas) + std::string("\x03\0", 2) + big(sum);
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string both = type + data;
  return big(data.size()) + both +
         big(crc32(0, reinterpret_cast<const Bytef*>(both.data()), static_cast<uInt>(both.size())));
}

std::string png(int width, int height, const std::string& ancillary, const std::string& pixels) {
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", big(static_cast<std::uint64_t>(width)) + big(static_cast<std::uint64_t>(height)) +
                           std::string("\x08\x02\0\0\0", 5)) +
         ancillary + pixels + chunk("IEND", "");
}

std::string jpeg(int width, int height, int frames, int scans, const std::string& application = {}) {
  std::string out = "\xff\xd8" + application + std::string("\xff\xdb\0\x43\0", 5) + std::string(64, 1);
  const std::string frame =
      std::string("\xff\xc2\0\x11\x08", 5) + big(static_cast<std::uint64_t>(height), 2) +
      big(static_cast<std::uint64_t>(width), 2) + std::string("\x03\1\x11\0\2\x11\0\3\x11\0", 10);
  out += repeated(frame, static_cast<std::size_t>(frames));
  for (const char kind : {'\0', '\x10'})
    out += std::string("\xff\xc4\0\x14", 4) + kind + "\1" + std::string(15, '\0') + std::string(1, '\0');
  out += std::string("\xff\xda\0\x0c\3\1\0\2\0\3\0\0\0\0", 14) + std::string(10, '\0');
  const std::string detail = std::string("\xff\xda\0\x08\1\1\0\1\x3f\0", 10) + std::string(10, '\0');
  return out + repeated(detail, static_cast<std::size_t>(scans)) + "\xff\xd9";
}

struct Tag {
  int tag, type;
  std::uint64_t count, value;
};

std::string tiff(const std::vector<Tag>& tags, const std::string& data) {
  std::string out = std::string("II*\0\x08\0\0\0", 8) + little(tags.size(), 2);
  for (const Tag& tag : tags)
    out += little(static_cast<std::uint64_t>(tag.tag), 2) + little(static_cast<std::uint64_t>(tag.type), 2) +
           little(tag.count) + little(tag.value);
  return out + little(0) + data;
}

/// Where the data of a TIFF with so many tags begins.
std::uint64_t after(std::size_t tags) { return 8 + 2 + 12 * tags + 4; }

std::vector<Tag> grey(std::uint64_t width, std::uint64_t height) {
  return {{256, 4, 1, width}, {257, 4, 1, height}, {258, 3, 1, 8}, {259, 3, 1, 1}, {262, 3, 1, 1}};
}

std::string tiff_of_tiles(std::uint64_t side) {
  std::vector<Tag> tags = grey(64, 48);
  tags.insert(
      tags.end(),
      {{277, 3, 1, 1}, {322, 4, 1, side}, {323, 4, 1, side}, {324, 4, 1, after(9)}, {325, 4, 1, 4000}});
  tags.erase(tags.begin() + 3);  // none is uncompressed, which is what is said by none
  return tiff(tags, std::string(4000, '\0'));
}

std::string tiff_of_strips_that_overlap() {
  constexpr std::uint64_t kRows = 60000;
  std::vector<Tag> tags = grey(1, kRows);
  tags[3].value = 8;  // deflate
  const std::uint64_t begin = after(9), bytes = 4 * kMega;
  tags.insert(tags.end(),
              {{273, 4, kRows, begin}, {277, 3, 1, 1}, {278, 4, 1, 1}, {279, 4, kRows, begin + 4 * kRows}});
  return tiff(tags, repeated(little(begin + 8 * kRows), kRows) + repeated(little(bytes), kRows) +
                        packed(std::string(1, '\0')) + std::string(bytes, '\0'));
}

std::string tiff_of_tags_that_overlap() {
  constexpr std::size_t kTags = 2000, kBytes = 2 * kMega;
  std::vector<Tag> tags = grey(64, 48);
  const std::uint64_t begin = after(tags.size() + 4 + kTags);
  tags.insert(tags.end(), {{273, 4, 1, begin}, {277, 3, 1, 1}, {278, 4, 1, 48}, {279, 4, 1, 64 * 48}});
  for (std::size_t i = 0; i < kTags; ++i) tags.push_back({static_cast<int>(40000 + i), 7, kBytes, begin});
  return tiff(tags, std::string(kBytes, '\0'));
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value,
                      std::uint64_t claimed = 0) {
  return name + '\0' + type + '\0' + little(claimed == 0 ? value.size() : claimed) + value;
}

struct Exr {
  int width = 64, height = 48, flags = 0;
  std::size_t channels = 0;  // beyond three
  std::string attributes = {};
};

std::string exr(const Exr& of) {
  std::string channels;
  const auto add = [&](const std::string& name) {
    channels += name + '\0' + little(1) + little(0) + little(1) + little(1);
  };
  for (const char* name : {"B", "G", "R"}) add(name);
  for (std::size_t i = 0; i < of.channels; ++i) add("c" + std::to_string(i));
  const std::string window = little(0) + little(0) + little(static_cast<std::uint64_t>(of.width - 1)) +
                             little(static_cast<std::uint64_t>(of.height - 1));
  return little(20000630) + little(static_cast<std::uint64_t>(2 | of.flags)) +
         attribute("channels", "chlist", channels + '\0') + attribute("compression", "compression", "\3") +
         attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window) +
         attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
         attribute("pixelAspectRatio", "float", std::string("\0\0\x80\x3f", 4)) +
         attribute("screenWindowCenter", "v2f", std::string(8, '\0')) +
         attribute("screenWindowWidth", "float", std::string("\0\0\x80\x3f", 4)) + of.attributes + '\0' +
         std::string(100000, '\0');
}

std::string openraster(const std::vector<std::pair<std::string, std::string>>& parts) {
  zip_error_t error;
  zip_source_t* source = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(source);
  zip_t* zip = zip_open_from_source(source, ZIP_TRUNCATE, &error);
  for (const auto& [name, bytes] : parts)
    zip_file_add(zip, name.c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0), 0);
  zip_close(zip);
  zip_stat_t stat;
  zip_source_stat(source, &stat);
  zip_source_open(source);
  std::string out(stat.size, '\0');
  zip_source_read(source, out.data(), out.size());
  zip_source_close(source);
  zip_source_free(source);
  return out;
}

}  // namespace

std::string png_of(int width, int height, const std::string& ancillary, const std::string& excess) {
  std::string rows;
  std::uint32_t state = 1;
  for (int y = 0; y < height; ++y) {
    rows += '\0';
    for (int x = 0; x < 3 * width; ++x)
      rows += static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  }
  return png(width, height, ancillary, chunk("IDAT", packed(rows) + excess));
}

std::vector<Bomb> picture_bombs() {
  const std::string zeros = packed_zeros(1024), few = packed_zeros(8);
  const std::string key("x\0\0", 3);
  const std::string control =
      chunk("acTL", big(1) + big(0)) +
      chunk("fcTL", big(0) + big(64) + big(48) + big(0) + big(0) + big(0x00010019) + std::string("\0\0", 2));
  std::string icc;
  for (int i = 1; i < 256; ++i)
    icc += "\xff\xe2" + big(2 + 14 + 60000, 2) + std::string("ICC_PROFILE\0", 12) + static_cast<char>(i) +
           "\xff" + std::string(60000, 'A');
  std::vector<Bomb> all{
      {"ztxt.png", png_of(64, 48, chunk("zTXt", key + zeros))},
      {"many.png", png_of(64, 48, repeated(chunk("zTXt", key + few), 300))},
      {"itxt.png", png_of(64, 48, chunk("iTXt", std::string("x\0\1\0\0\0", 6) + zeros))},
      {"text.png", png_of(64, 48, chunk("tEXt", std::string("x\0", 2) + std::string(8 * kMega, 'A')))},
      {"iccp.png", png_of(64, 48, chunk("iCCP", key + zeros))},
      {"iccps.png", png_of(64, 48, repeated(chunk("iCCP", key + few), 300))},
      {"excess.png", png_of(64, 48, {}, packed_zeros(1024))},
      {"empty.png", png_of(64, 48, repeated(chunk("IDAT", ""), 300000))},
      {"apng.png", png_of(64, 48, chunk("zTXt", key + zeros) + control)},
      {"tall.png", png_of(1, 65535)},
      {"wide.png", png_of(65535, 1)},
      {"scans.jpg", jpeg(250, 250, 1, 100000)},
      {"frames.jpg", jpeg(16000, 16000, 20000, 0)},
      {"claim.jpg", jpeg(16000, 16000, 1, 0)},
      {"icc.jpg", jpeg(64, 48, 1, 0, icc)},
      {"tiles.tif", tiff_of_tiles(1u << 15)},
      {"strips.tif", tiff_of_strips_that_overlap()},
      {"tags.tif", tiff_of_tags_that_overlap()},
      {"claim.tif", tiff(grey(16000, 16000), std::string(100, '\0'))},
      {"string.exr", exr({.attributes = attribute("s", "string", "a", 0x7fffffff)})},
      {"strings.exr", exr({.attributes = attribute("s", "stringvector", little(0x7ffffff0) + "a")})},
      {"opaque.exr", exr({.attributes = attribute("s", "unknown", "a", 0x7fffffff)})},
      {"preview.exr", exr({.attributes = attribute("preview", "preview", little(20000) + little(20000))})},
      {"tiles.exr",
       exr({.flags = 0x200,
            .attributes =
                attribute("tiles", "tiledesc", little(1u << 15) + little(1u << 14) + std::string(1, '\0'))})},
      {"small_tiles.exr",
       exr({.width = 8192,
            .height = 8192,
            .flags = 0x200,
            .attributes = attribute("tiles", "tiledesc", little(1) + little(1) + std::string(1, '\0'))})},
      {"tall.exr", exr({.width = 1, .height = 100'000'000})},
      {"channels.exr", exr({.width = 4096, .height = 16, .channels = 8000})},
      {"parts.exr",
       exr({.flags = 0x1000,
            .attributes = attribute("name", "string", "a") + attribute("type", "string", "scanlineimage") +
                          attribute("chunkCount", "int", little(0x7fffffff))})},
      {"claim.webp", "RIFF" + little(36) + "WEBPVP8L" + little(24) + "\x2f" +
                         std::string("\xfe\xbf\xff\x0f", 4) + std::string(19, '\0')},
      {"claim.pgm", "P5 30000 30000 255\n" + std::string(100, '\0')},
      {"claim.ppm", "P3 16000 16000 255\n1 2 3\n" + std::string(100, ' ')},
      {"claim.pam", "P7\nWIDTH 30000\nHEIGHT 30000\nDEPTH 4\nMAXVAL 255\nTUPLTYPE RGB_ALPHA\nENDHDR\n" +
                        std::string(100, '\0')},
      {"claim.pfm", "PF\n30000 30000\n-1.0\n" + std::string(100, '\0')},
      {"claim.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\n" + std::string(100, '\0')},
      {"claim.ras", big(0x59a66a95) + big(30000) + big(30000) + big(24) + big(0) + big(1) + big(0) + big(0) +
                        std::string(100, '\0')},
      {"claim.bmp", "BM" + little(200) + little(0) + little(54) + little(40) + little(16000) + little(16000) +
                        little(1, 2) + little(24, 2) + std::string(150, '\0')},
  };
  std::string siz = big(0, 2);  // Rsiz
  for (const unsigned value : {256u, 256u, 0u, 0u, 1u, 1u, 0u, 0u}) siz += big(value);
  siz += big(3, 2) + repeated(std::string("\x07\1\1", 3), 3);
  std::string stream = "\xff\x4f\xff\x51" + big(2 + siz.size(), 2) + siz +
                       std::string("\xff\x52\0\x0c\0\0\0\1\0\5\4\4\0\1", 14) +
                       std::string("\xff\x5c\0\x13\x40", 5) + std::string(16, '\x48') +
                       std::string("\xff\x90\0\x0a\0\0\0\0\0\x0e\0\1\xff\x93\xff\xd9", 16);
  all.push_back({"tiles.jp2", big(12) + std::string("jP  \r\n\x87\n", 8) + big(20) + "ftypjp2 " + big(0) +
                                  "jp2 " + big(45) + "jp2h" + big(22) + "ihdr" + big(256) + big(256) +
                                  big(3, 2) + std::string("\7\7\0\0", 4) + big(15) + "colr" +
                                  std::string("\1\0\0", 3) + big(16) + big(0) + "jp2c" + stream});
  all.push_back({"claim.flo", "PIEH" + little(32768) + little(32768) + std::string(100, '\0')});
  return all;
}

std::vector<Bomb> openraster_bombs() {
  const auto stack = [](const std::string& layers) {
    return "<?xml version=\"1.0\"?><image w=\"64\" h=\"48\"><stack>" + layers + "</stack></image>";
  };
  const auto ora = [](const std::string& xml, const std::string& layer) {
    return openraster({{"mimetype", "image/openraster"}, {"stack.xml", xml}, {"data/l.png", layer}});
  };
  const std::string one = "<layer name=\"a\" src=\"data/l.png\"/>";
  const std::string text = chunk("tEXt", std::string("x\0", 2) + std::string(64 * kMega, 'A'));
  return {{"ztxt.ora",
           ora(stack(one), png_of(64, 48, chunk("zTXt", std::string("x\0\0", 3) + packed_zeros(1024))))},
          {"large.ora", ora(stack(one), png_of(64, 48, repeated(text, 8)))},
          {"layers.ora", ora(stack(repeated(one, 1000)), png_of(64, 48, text))},
          {"name.ora", ora(stack("<layer name=\"" + std::string(kMega, 'A') + "\" src=\"no.png\"/>"), "x")}};
}

}  // namespace freshet::media
