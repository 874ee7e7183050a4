#include "synth/stills/between/kept_between.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "cache/content_hash.h"

namespace freshet::synth::stills {
namespace {

std::span<const std::byte> bytes_of(const cv::Mat& plane) {
  return std::as_bytes(std::span(plane.data, plane.total() * plane.elemSize()));
}

}  // namespace

FlowPair KeptBetween::flow(const cv::Mat& from, const cv::Mat& to) const {
  if (cache_ == nullptr) return flow_between(from, to);
  cache::KeyHash hash;
  hash.add(std::string("stills flow 2"));
  hash.add(cache::content_hash(from));
  hash.add(cache::content_hash(to));
  const std::size_t plane = 2 * sizeof(std::int16_t) * from.total();
  if (const auto kept = cache_->find(hash.key()); kept && kept->size() == 2 * plane) {
    FlowPair flow{cv::Mat(from.size(), CV_16SC2), cv::Mat(from.size(), CV_16SC2)};
    std::memcpy(flow.forth.data, kept->data(), plane);
    std::memcpy(flow.back.data, kept->data() + plane, plane);
    return flow;
  }
  const FlowPair flow = flow_between(from, to);
  std::vector<std::byte> bytes(2 * plane);
  std::memcpy(bytes.data(), flow.forth.data, plane);
  std::memcpy(bytes.data() + plane, flow.back.data, plane);
  cache_->keep(hash.key(), bytes);
  return flow;
}

cv::Mat KeptBetween::picture(const BetweenKey& key, int type, const std::function<cv::Mat()>& make) const {
  if (cache_ == nullptr) return make();
  cache::KeyHash hash;
  hash.add(std::string("stills between 2"));
  hash.add(key.a);
  hash.add(key.b);
  for (const int each : {key.box.x, key.box.y, key.box.width, key.box.height}) hash.add(std::int32_t{each});
  hash.add(key.phase);
  hash.add(std::int32_t{key.flow_side});
  for (const FlowPin& pin : key.pins)
    for (const float each : {pin.at.x, pin.at.y, pin.goes.x, pin.goes.y, pin.reach})
      hash.add(static_cast<double>(each));
  cv::Mat picture(key.box.size(), type);
  if (const auto kept = cache_->find(hash.key()); kept && kept->size() == bytes_of(picture).size()) {
    std::memcpy(picture.data, kept->data(), kept->size());
    return picture;
  }
  picture = make();
  cache_->keep(hash.key(), bytes_of(picture));
  return picture;
}

}  // namespace freshet::synth::stills
