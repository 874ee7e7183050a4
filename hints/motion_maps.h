// hints/motion_maps.h — directions and speeds as pictures that any paint program can edit.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::hints {

/// White of a speed map when nothing else is said, px/s. In a paint program of 8 bits a step of grey is then
/// one px/s. In a store of 46 clips 96 % of the patches move slower. Half of them move by less than 22 px/s:
/// a greater white would make these black.
constexpr double kSpeedWhite = 255;
/// Slower motion has no direction worth a colour, px/s.
constexpr double kMinDirectedSpeed = 0.5;

/// Speed map: grey, black stands still, white is `white_px_per_s`, even steps between;
/// transparent: not asked.
/// notices  for a person: colour reduced to grey.
/// Returns  CV_32F of `picture`'s size, px/s, negative where not asked: MotionGuide::speed.
/// Throws   Error{kInput} naming the file: not a picture, another size, nothing asked anywhere;
///          Error{kUsage} when white is not above 0.
cv::Mat read_speed_map(const std::filesystem::path& path, cv::Size picture, double white_px_per_s,
                       std::vector<std::string>* notices = nullptr);

/// Orientation map: the colour's hue is the direction in degrees as --direction counts them (red 0 right,
/// yellow-green 90 up, cyan 180 left, violet 270 down). Grey, near black (below a tenth of white), pale
/// (saturation below a quarter) or transparent: not asked.
/// Returns  CV_32FC2 of `picture`'s size, unit vectors or (0, 0): MotionGuide::direction.
/// Throws   as read_speed_map; a wholly grey map asks nothing.
cv::Mat read_orientation_map(const std::filesystem::path& path, cv::Size picture,
                             std::vector<std::string>* notices = nullptr);

/// Speed and direction of a motion field as such maps, 16 bits per channel, PNG or TIFF. Where the matte is 0
/// or the motion (0, 0) nothing is asked: transparent in a map of speeds, grey in one of directions (there
/// below kMinDirectedSpeed too).
/// motion   CV_32FC2, px/s, x right, y down.
/// matte    CV_8U of its size.
/// Returns  (write_speed_map) the fraction of moving pixels above white, which are cut off to it.
/// Throws   Error{kUsage} for another ending, Error{kIo}.
double write_speed_map(const std::filesystem::path& path, const cv::Mat& motion, const cv::Mat& matte,
                       double white_px_per_s);
void write_orientation_map(const std::filesystem::path& path, const cv::Mat& motion, const cv::Mat& matte);

/// Throws what the writers would for this name: for those who compute long before they write.
void check_map_name(const std::filesystem::path& path);

/// A motion field as a guide's maps: unit vectors, (0, 0) below kMinDirectedSpeed, and speeds, negative
/// where the field is (0, 0).
void split_motion(const cv::Mat& motion, const cv::Mat& matte, cv::Mat& direction, cv::Mat& speed);

/// A direction's colour, BGR 0..1, full and bright.
cv::Vec3f colour_of_direction(const cv::Vec2f& way);

}  // namespace freshet::hints
