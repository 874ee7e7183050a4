// include/freshet/motion.h — where and how fast a person wants the fluid of a picture to go.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet {

/// Where a plane of water ends in the distance: a line, px of the picture; `from` lies left of `to`.
struct Horizon {
  cv::Point2f from, to;
};

/// What is asked of the motion, pixel by pixel; either map alone, or both. Tolerances: SearchOptions::narrow.
struct MotionGuide {
  /// CV_32FC2, the picture's size: unit vectors, x right, y down; (0, 0): not asked there. Empty: nowhere.
  cv::Mat direction{};
  /// CV_32F, the picture's size: px/s; negative: not asked there. Empty: nowhere.
  cv::Mat speed{};
  /// Degrees to either side of the direction, 0 to 180.
  double tolerance_deg = 30;
  /// Speeds from asked / ratio to asked * ratio; at least 1.
  double speed_ratio = 1.5;
  /// Slower patches have no direction that counts.
  double min_speed_px_per_s = 2.5;
  /// Where no speed is asked, the patches go slower towards here, as a plane does that goes everywhere at one speed.
  std::optional<Horizon> horizon{};

  bool empty() const { return direction.empty() && speed.empty(); }
};

/// The guide that lines drawn over a picture make: SVG (paths, lines, polylines; data-speed in px/s) or the
/// JSON of `freshet --strokes`. picture   px.
/// notices   for a person, when not null: what was left out.
/// horizon   of the picture (find_horizon): speeds between the strokes shrink towards it.
/// Throws    Error{kInput} naming the file, the stroke and the remedy.
MotionGuide read_strokes(const std::filesystem::path& path, cv::Size picture,
                         std::vector<std::string>* notices = nullptr,
                         const std::optional<Horizon>& horizon = {});

/// The straight, level upper border of a matte of water, over at least half of the picture's width; nothing: a bank, a
/// rim, or no water, by its class or, where that is empty, its look.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size.
std::optional<Horizon> find_horizon(const cv::Mat& picture, const cv::Mat& matte,
                                    const std::string& class_name = {});

}  // namespace freshet
