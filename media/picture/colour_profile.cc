#include "media/picture/colour_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <lcms2.h>

#include "freshet/error.h"
#include "media/picture/tiff_tags.h"

namespace freshet::media {
namespace {

struct Close {
  void operator()(void* profile) const { cmsCloseProfile(profile); }
};
struct Delete {
  void operator()(void* transform) const { cmsDeleteTransform(transform); }
};
using Profile = std::unique_ptr<void, Close>;  // Little CMS's handles are void*
using Transform = std::unique_ptr<void, Delete>;

Transform transform(cmsHPROFILE from, cmsHPROFILE to, cmsUInt32Number format) {
  return Transform(cmsCreateTransform(from, format, to, format, INTENT_RELATIVE_COLORIMETRIC, 0));
}

/// A lattice of colours goes through unchanged.
bool is_srgb(cmsHTRANSFORM in_float) {
  constexpr int kSteps = 6;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const std::array<float, 3> from{static_cast<float>(i % kSteps) / (kSteps - 1),
                                    static_cast<float>(i / kSteps % kSteps) / (kSteps - 1),
                                    static_cast<float>(i / kSteps / kSteps) / (kSteps - 1)};
    std::array<float, 3> to{};
    cmsDoTransform(in_float, from.data(), to.data(), 1);
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(to[k] - from[k]) > 0.01f) return false;
  }
  return true;
}

/// Of the picture's pixels, how many lie outside sRGB; of a sample.
double fraction_outside(cmsHTRANSFORM in_float, const cv::Mat& bgr) {
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(bgr.total()) / 1e5)));
  std::size_t seen = 0, outside = 0;
  cv::Mat row;
  for (int y = 0; y < bgr.rows; y += step) {
    bgr.row(y).convertTo(row, CV_32F, bgr.depth() == CV_8U ? 1.0 / 255 : 1.0 / 65535);
    cmsDoTransform(in_float, row.data, row.data, static_cast<cmsUInt32Number>(row.cols));
    for (int x = 0; x < row.cols; x += step) {
      const cv::Vec3f& at = row.at<cv::Vec3f>(x);
      ++seen;
      outside += std::any_of(at.val, at.val + 3, [](float v) { return v < -0.004f || v > 1.004f; });
    }
  }
  return static_cast<double>(outside) / static_cast<double>(seen);
}

std::string name_of(cmsHPROFILE profile) {
  std::array<char, 128> text{};
  cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text.data(), text.size() - 1);
  return text[0] == 0 ? std::string("without a name") : fmt::format("\"{}\"", text.data());
}

}  // namespace

std::vector<std::uint8_t> tiff_profile(std::span<const std::uint8_t> bytes) {
  constexpr unsigned kProfile = 34675;
  const TiffTags tiff(bytes);
  const std::optional<TiffTags::Tag> tag = tiff.find(kProfile);
  if (!tag) return {};
  const std::span<const std::uint8_t> profile = tiff.bytes_of(*tag);
  if (profile.size() != TiffTags::length_of(*tag)) return {};
  return {profile.begin(), profile.end()};
}

std::string bring_to_srgb(std::span<const std::uint8_t> icc, cv::Mat& bgr,
                          const std::filesystem::path& where) {
  cmsSetLogErrorHandler([](cmsContext, cmsUInt32Number, const char*) {});
  const Profile own(cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size())));
  const auto refuse = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, where.string(), fault,
                "Convert it to sRGB in your picture program, or save it without a profile");
  };
  if (!own) refuse("its colour profile is damaged");
  const cmsColorSpaceSignature space = cmsGetColorSpace(own.get());
  if (space == cmsSigGrayData) return {};
  if (space != cmsSigRgbData) refuse("its colour profile " + name_of(own.get()) + " is not one of RGB");
  const Profile srgb(cmsCreate_sRGBProfile());
  const Transform in_float = transform(own.get(), srgb.get(), TYPE_BGR_FLT);
  const Transform direct = transform(own.get(), srgb.get(), bgr.depth() == CV_8U ? TYPE_BGR_8 : TYPE_BGR_16);
  if (!in_float || !direct) refuse("its colour profile " + name_of(own.get()) + " cannot be used");
  if (is_srgb(in_float.get())) return {};
  const double outside = fraction_outside(in_float.get(), bgr);
  for (int y = 0; y < bgr.rows; ++y)
    cmsDoTransform(direct.get(), bgr.ptr(y), bgr.ptr(y), static_cast<cmsUInt32Number>(bgr.cols));
  return fmt::format(
      "its colours are brought from the profile {} to sRGB{}", name_of(own.get()),
      outside > 0 ? fmt::format("; {:.1f} % of the pixels lie outside and are clipped", 100 * outside) : "");
}

}  // namespace freshet::media
