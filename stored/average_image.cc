#include "stored/average_image.h"

#include <cstdint>
#include <vector>

#include "freshet/error.h"

namespace freshet::stored {

cv::Mat average_image(const store::Snapshot& snapshot, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const store::StreamShape expected{{{record.width, record.height, 2}}, 1};
  if (record.average != expected) {
    throw Error(ErrorKind::kDamaged, record.name,
                "its average image is not one plane of 16 bits of the clip's size", "Ingest the clip again");
  }
  const std::size_t pixels = std::size_t{record.width} * record.height;
  std::vector<std::uint16_t> luma(pixels);
  snapshot.read(clip, store::Stream::kAverage, 0, {0, 0, record.width, record.height}, 0, 1,
                std::as_writable_bytes(std::span(luma)));
  cv::Mat image(static_cast<int>(record.height), static_cast<int>(record.width), CV_8U);
  for (std::size_t i = 0; i < pixels; ++i) image.data[i] = static_cast<std::uint8_t>((luma[i] + 128u) / 257u);
  return image;
}

}  // namespace freshet::stored
