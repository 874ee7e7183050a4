// tools/store/store_page.h — what a store holds and lacks, as a page for a person and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>

namespace freshet::tools {

/// Frames beside each other in one JPEG: a page plays them.
struct PlayedStrip {
  std::vector<std::uint8_t> jpeg;
  int frames = 0;
  cv::Size frame;  // px
  double seconds = 0;
};

struct ShownClip {
  std::string name, class_name, licence, author, source;
  cv::Size size;  // px
  double fps = 0, seconds = 0;
  std::uint64_t patches = 0;
  double speed = 0;        // median of its upright patches, longer sides of the frame a second
  double light = 0;        // mean, 0..1
  double half_life_s = 0;  // of its detail; 0: not measured
  double alike = -1;       // Likeness::clips
  PlayedStrip strip;
};

/// A picture that is to be animated.
struct AskedPicture {
  std::string name, kind;
  bool kind_sure = false;
  double unlike = 0;               // unlike_share
  double unlike_reduced = 0;       // of the picture at half the size
  std::vector<std::uint8_t> jpeg;  // with red where pieces look like nothing in the store
};

struct StoreContents {
  std::string store;
  std::uint64_t bytes = 0;
  std::vector<ShownClip> clips;  // in the store's order
  std::vector<AskedPicture> pictures;
};

/// Which speeds a clip has for its class: "slow", "natural", "fast"; "" where nothing is known of the class.
std::string pace_of(const ShownClip& clip);
/// Sentences: kinds and speeds that no clip has, pictures that nothing looks like.
std::vector<std::string> lacks_of(const StoreContents& contents);

std::string store_page(const StoreContents& contents);
nlohmann::json to_json(const StoreContents& contents);

}  // namespace freshet::tools
