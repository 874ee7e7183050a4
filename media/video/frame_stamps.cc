#include "media/video/frame_stamps.h"

#include <algorithm>
#include <cstdint>
#include <system_error>

#include "media/frame/decoder.h"
#include "media/picture/picture_sequence.h"

namespace freshet::media {

std::vector<double> frame_stamps(const std::filesystem::path& video) {
  std::error_code fault;
  if (std::filesystem::is_directory(video, fault) ||
      (!std::filesystem::exists(video, fault) && is_pattern(video)))
    return {};
  Decoder decoder(video, {.threads = 1});
  const AVFieldOrder order = decoder.stream().codecpar->field_order;
  if (order != AV_FIELD_UNKNOWN && order != AV_FIELD_PROGRESSIVE) return {};  // a packet may be a field
  std::vector<std::int64_t> stamps = decoder.packet_stamps();
  std::ranges::sort(stamps);
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  const double unit_s = av_q2d(decoder.stream().time_base);
  std::vector<double> times_s;
  for (const std::int64_t stamp : stamps)
    times_s.push_back((static_cast<double>(stamp) - static_cast<double>(stamps.front())) * unit_s);
  return times_s;
}

}  // namespace freshet::media
