#include "media/picture/openraster.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <zip.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "tests/harness/fault.h"
#include "tests/harness/noise.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

OpenRaster two_layers() {
  cv::Mat front = noise({20, 16}, CV_8UC4, 1), behind = noise({64, 48}, CV_16UC4, 2, 0, 65536);
  front.row(0).setTo(cv::Scalar::all(0));  // cropped when it is written
  behind.forEach<cv::Vec4w>([](cv::Vec4w& pixel, const int*) { pixel[3] = 65535; });
  return {.canvas = {64, 48},
          .layers = {{.name = "a <tree> & \"more\"", .pixels = front, .at = {-5, 12}, .opacity = 0.5f},
                     {.name = "sky", .pixels = behind, .at = {}}},
          .notices = {}};
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A zip of these parts, as somebody else would write it: packed, and in any order.
void write_zip(const fs::path& path, const std::vector<std::pair<std::string, std::string>>& parts) {
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  for (const auto& [name, text] : parts)
    zip_file_add(zip, name.c_str(), zip_source_buffer(zip, text.data(), text.size(), 0), ZIP_FL_OVERWRITE);
  ASSERT_EQ(zip_close(zip), 0);
}

std::string png(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

constexpr const char* kMime = "image/openraster";

std::string stack(const std::string& layers, const std::string& size = "w='8' h='6'") {
  return "<?xml version='1.0'?><image version='0.0.1' " + size + "><stack>" + layers + "</stack></image>";
}

std::string fault_of(const fs::path& path) {
  const std::string said = fault_of(ErrorKind::kInput, [&] { read_openraster(path); });
  EXPECT_EQ(said.find(path.string()), 0u);
  return said;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(OpenRaster, ComesBackAsWritten) {
  const ScratchFolder scratch;
  const OpenRaster written = two_layers();
  write_openraster(scratch / "a.ora", written);
  const OpenRaster back = read_openraster(scratch / "a.ora");
  EXPECT_EQ(back.canvas, written.canvas);
  EXPECT_TRUE(back.notices.empty());
  ASSERT_EQ(back.layers.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back.layers[i].name, written.layers[i].name);
    EXPECT_EQ(back.layers[i].opacity, written.layers[i].opacity);
    EXPECT_TRUE(back.layers[i].visible);
    ASSERT_EQ(back.layers[i].pixels.type(), written.layers[i].pixels.type());
    EXPECT_EQ(cv::norm(on_canvas(back.layers[i], back.canvas), on_canvas(written.layers[i], written.canvas),
                       cv::NORM_INF),
              0);
  }
  EXPECT_LT(back.layers[0].pixels.rows, 16);
}

TEST(OpenRaster, IsTheSameBytesEachTimeWithTheMimetypeFirstAndPlain) {
  const ScratchFolder scratch;
  write_openraster(scratch / "a.ora", two_layers());
  write_openraster(scratch / "b.ora", two_layers());
  const std::string bytes = bytes_of(scratch / "a.ora");
  EXPECT_EQ(bytes, bytes_of(scratch / "b.ora"));
  // A local header has 30 bytes, then its name; what follows must be the type itself, for `file` and its like.
  EXPECT_EQ(bytes.substr(30, 8 + 16), std::string("mimetype") + kMime);
}

TEST(OpenRaster, OthersReadWhatTheLayersGiveTogether) {
  const ScratchFolder scratch;
  OpenRaster written = two_layers();
  written.layers.push_back(
      {.name = "hidden", .pixels = noise({64, 48}, CV_8UC4, 5), .at = {}, .visible = false});
  std::rotate(written.layers.begin(), written.layers.end() - 1, written.layers.end());
  write_openraster(scratch / "a.ora", written);
  // Python's zipfile checks each part's sum; the order of the parts is that of its list.
  const std::string command =
      "python3 -c \"import sys, zipfile; z = zipfile.ZipFile('" + (scratch / "a.ora").string() +
      "'); n = z.namelist(); sys.exit(3 if z.testzip() or n[0] != 'mimetype' or "
      "z.infolist()[0].compress_type or "
      "not {'stack.xml', 'mergedimage.png', 'Thumbnails/thumbnail.png'} <= set(n) else "
      "z.extractall('" +
      scratch.path().string() + "'))\"";
  const int status = std::system((command + " 2>/dev/null").c_str());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    GTEST_SKIP() << "no python3: no other reader was asked";
  ASSERT_EQ(status, 0);
  const cv::Mat thumbnail = cv::imread(scratch / "Thumbnails/thumbnail.png", cv::IMREAD_UNCHANGED);
  EXPECT_EQ(thumbnail.type(), CV_8UC4);
  EXPECT_LE(std::max(thumbnail.cols, thumbnail.rows), 256);
  const cv::Mat seen = cv::imread(scratch / "mergedimage.png", cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
  cv::Mat expected;
  cv::cvtColor(merged(written), expected, cv::COLOR_BGRA2BGR);
  ASSERT_EQ(seen.type(), expected.type());
  EXPECT_EQ(cv::norm(seen, expected, cv::NORM_INF), 0);
}

TEST(OpenRaster, MergesFromBelow) {
  OpenRaster raster{.canvas = {2, 1}, .layers = {}, .notices = {}};
  raster.layers.push_back({.name = "half",
                           .pixels = cv::Mat(1, 1, CV_8UC4, cv::Scalar(255, 0, 0, 255)),
                           .at = {1, 0},
                           .opacity = 0.5f});
  raster.layers.push_back(
      {.name = "below", .pixels = cv::Mat(1, 2, CV_8UC4, cv::Scalar(0, 0, 255, 255)), .at = {}});
  const cv::Mat seen = merged(raster);
  EXPECT_EQ(seen.at<cv::Vec4w>(0, 0), cv::Vec4w(0, 0, 65535, 65535));
  EXPECT_NEAR(seen.at<cv::Vec4w>(0, 1)[0], 0.5 * 65535, 200);
  EXPECT_NEAR(seen.at<cv::Vec4w>(0, 1)[2], 0.5 * 65535, 200);
}

TEST(OpenRaster, GroupsAreDissolved) {
  const ScratchFolder scratch;
  write_zip(scratch / "a.ora",
            {{"stack.xml", stack("<stack opacity='0.5' visibility='hidden' name='g'>"
                                 "<layer name='inside' src='data/1.png' opacity='0.5' x='2' y='-1'/></stack>"
                                 "<layer name='grey' src='data/2.png' composite-op='svg:multiply'/><text/>")},
             {"data/1.png", png(noise({3, 3}, CV_8UC3, 1))},
             {"data/2.png", png(noise({8, 6}, CV_8UC1, 1))},
             {"mimetype", std::string(kMime) + "\n"}});
  const OpenRaster read = read_openraster(scratch / "a.ora");
  ASSERT_EQ(read.layers.size(), 2u);
  EXPECT_FLOAT_EQ(read.layers[0].opacity, 0.25f);
  EXPECT_FALSE(read.layers[0].visible);
  EXPECT_EQ(read.layers[0].at, cv::Point(2, -1));
  EXPECT_EQ(read.layers[0].pixels.type(), CV_8UC4);
  EXPECT_EQ(read.layers[0].pixels.at<cv::Vec4b>(1, 1)[3], 255);
  ASSERT_EQ(read.notices.size(), 2u);
  EXPECT_TRUE(holds(read.notices[0], "svg:multiply"));
}

TEST(OpenRaster, ACornerFarOutsideIsBorne) {
  const RasterLayer layer{
      .name = "far", .pixels = noise({3, 3}, CV_8UC4, 1), .at = {2147483646, -2147483647}};
  EXPECT_EQ(cv::norm(on_canvas(layer, {5, 5}), cv::NORM_INF), 0);
}

TEST(OpenRaster, CutAnywhereItIsRefused) {
  const ScratchFolder scratch;
  write_openraster(scratch / "a.ora", two_layers());
  const std::string bytes = bytes_of(scratch / "a.ora");
  for (std::size_t length = 1; length < bytes.size(); length += bytes.size() / 23) {
    std::ofstream(scratch / "cut.ora", std::ios::binary) << bytes.substr(0, length);
    EXPECT_TRUE(holds(fault_of(scratch / "cut.ora"), "not a whole zip archive")) << length;
  }
}

TEST(OpenRaster, AFlippedByteIsRefusedOrChangesNothingThatIsRead) {
  const ScratchFolder scratch;
  write_openraster(scratch / "a.ora", two_layers());
  const OpenRaster whole = read_openraster(scratch / "a.ora");
  const std::string bytes = bytes_of(scratch / "a.ora");
  int refused = 0, tried = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 200, ++tried) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    std::ofstream(scratch / "flipped.ora", std::ios::binary) << flipped;
    try {
      const OpenRaster back = read_openraster(scratch / "flipped.ora");
      ASSERT_EQ(back.layers.size(), whole.layers.size()) << at;
      for (std::size_t i = 0; i < back.layers.size(); ++i) {
        EXPECT_EQ(back.layers[i].name, whole.layers[i].name) << at;
        EXPECT_EQ(cv::norm(back.layers[i].pixels, whole.layers[i].pixels, cv::NORM_INF), 0) << at;
      }
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 4);  // nobody reads what the layers give together
}

TEST(OpenRaster, FaultsNameThePartAndTheRemedy) {
  const ScratchFolder scratch;
  const fs::path path = scratch / "a.ora";
  const std::string layer = "<layer name='one' src='data/1.png'/>", picture = png(noise({8, 6}, CV_8UC4, 1));
  const auto fault = [&](const std::vector<std::pair<std::string, std::string>>& parts) {
    write_zip(path, parts);
    return fault_of(path);
  };
  write_zip(path, {{"mimetype", kMime}, {"stack.xml", stack(layer)}, {"data/1.png", picture}});
  EXPECT_NO_THROW(read_openraster(path));
  EXPECT_TRUE(holds(fault({{"stack.xml", stack(layer)}}), "without a mimetype"));
  EXPECT_TRUE(holds(fault({{"mimetype", "application/zip"}}), "its mimetype is \"application/zip\""));
  EXPECT_TRUE(holds(fault({{"mimetype", kMime}}), "stack.xml, which lists the layers, is missing"));
  const auto with = [&](const std::string& xml, const std::string& data = "") {
    return fault({{"mimetype", kMime}, {"stack.xml", xml}, {"data/1.png", data.empty() ? picture : data}});
  };
  EXPECT_TRUE(holds(with("<image w='8' h='6'><stack>"), "stack.xml is not whole"));
  EXPECT_TRUE(holds(with("<html/>"), "no stack of layers"));
  EXPECT_TRUE(holds(with(stack("")), "it has no layers"));
  EXPECT_TRUE(holds(with(stack(layer, "w='100000' h='100000'")), "its canvas is 100000 x 100000"));
  EXPECT_TRUE(holds(with(stack(layer, "w='-8' h='x'")), "not a number"));
  EXPECT_TRUE(holds(with(stack(layer, "")), "its canvas is 0 x 0"));
  EXPECT_TRUE(holds(with(stack("<layer name='up' src='../../etc/passwd'/>")), "layer \"up\": its source"));
  EXPECT_TRUE(holds(with(stack("<layer name='up' src='/etc/passwd'/>")), "no name inside of the file"));
  EXPECT_TRUE(holds(with(stack("<layer name='gone' src='data/9.png'/>")), "data/9.png is missing"));
  EXPECT_TRUE(holds(with(stack("<layer name='far' src='data/1.png' x='1e30'/>")), "x of a layer"));
  const std::string long_name =
      with(stack("<layer name='" + std::string(1 << 20, 'A') + "' src='data/1.png'/>"));
  EXPECT_TRUE(holds(long_name, "a layer's name has 1048576 bytes"));
  EXPECT_LT(long_name.size(), 300U);
  EXPECT_TRUE(holds(with(stack(layer), "GIF89a, and what follows in such a file"), "is no PNG"));
  EXPECT_TRUE(holds(with(stack(layer), picture.substr(0, picture.size() / 2)), "is cut short"));
  std::string nested;
  for (int i = 0; i < 200; ++i) nested += "<stack>";
  nested += layer;
  for (int i = 0; i < 200; ++i) nested += "</stack>";
  EXPECT_TRUE(holds(with(stack(nested)), "deep"));
  std::string many;
  for (int i = 0; i < 1001; ++i) many += layer;
  EXPECT_TRUE(holds(with(stack(many)), "more than 1000 layers"));
}

TEST(OpenRaster, EntitiesAreNotExpanded) {
  const ScratchFolder scratch;
  const std::string text =
      "<?xml version='1.0'?><!DOCTYPE image [<!ENTITY a SYSTEM 'file:///etc/passwd'>"
      "<!ENTITY b '&a;&a;&a;&a;&a;&a;'>]>"
      "<image w='8' h='6'><stack><layer name='&b;' src='data/1.png'/></stack></image>";
  write_zip(scratch / "a.ora",
            {{"mimetype", kMime}, {"stack.xml", text}, {"data/1.png", png(noise({8, 6}, CV_8UC4, 1))}});
  EXPECT_EQ(read_openraster(scratch / "a.ora").layers[0].name, "&b;");
}

TEST(OpenRaster, WhatUnpacksToTooMuchIsRefusedBeforeItIsUnpacked) {
  const ScratchFolder scratch;
  const fs::path path = scratch / "bomb.ora";
  // 64 MB of spaces are packed to 64 KB; stack.xml may have 4 MB.
  write_zip(path, {{"mimetype", kMime}, {"stack.xml", std::string(64u << 20, ' ')}});
  ASSERT_LT(fs::file_size(path), 1u << 20);
  EXPECT_TRUE(holds(fault_of(path), "says that it unpacks to 67108864 bytes"));
  // The same, with small sizes written over the true ones in the local and the central header.
  std::string bytes = bytes_of(path);
  const std::string size("\0\0\0\4", 4), small("\0\1\0\0", 4);
  int changed = 0;
  for (std::size_t at = bytes.find(size); at != std::string::npos; at = bytes.find(size, at + 4), ++changed)
    bytes.replace(at, 4, small);
  ASSERT_GE(changed, 1);
  std::ofstream(path, std::ios::binary) << bytes;
  fault_of(path);
  // A picture that claims more pixels than its bytes could hold.
  std::string picture = png(noise({8, 6}, CV_8UC4, 1));
  picture.replace(16, 8, std::string("\0\1\0\0\0\1\0\0", 8));
  write_zip(path, {{"mimetype", kMime},
                   {"stack.xml", stack("<layer name='one' src='data/1.png'/>")},
                   {"data/1.png", picture}});
  EXPECT_TRUE(holds(fault_of(path), "65536 x 65536 px: too large"));
}

TEST(OpenRaster, NothingIsWrittenOfWhatNoFileCanHold) {
  const ScratchFolder scratch;
  EXPECT_THROW(write_openraster(scratch / "a.ora", {}), Error);
  OpenRaster wrong = two_layers();
  wrong.layers[0].pixels = noise({4, 4}, CV_8UC3, 1);
  EXPECT_THROW(write_openraster(scratch / "a.ora", wrong), Error);
  EXPECT_THROW(write_openraster(scratch / "none" / "a.ora", two_layers()), Error);
  EXPECT_FALSE(fs::exists(scratch / "a.ora"));
}

}  // namespace
}  // namespace freshet::media
