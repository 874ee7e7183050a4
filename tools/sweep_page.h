// tools/sweep_page.h — the animations of a sweep beside each other: one picture, and one page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::tools {

/// What is shown of one combination.
struct SweptAnimation {
  std::string title;              // "sigma=100 rho=2"
  std::string video, assignment;  // names of files in the page's folder
  double energy = 0, gap = 0;     // gap: infinite when no bound is known
  double changed = 0;             // fraction of pieces whose patch is not the first combination's
  cv::Mat frame;                  // one of it, CV_8UC3
};

/// "energy 350.73, gap 0.01%", with ", above 1%" where it is more than query::kGapAimed.
std::string energy_text(const SweptAnimation& animation);

/// The still, then a frame of each animation, with its title and energy below. CV_8UC3; cells of at most
/// 480 px, in a grid that is about as wide as high.
cv::Mat sweep_sheet(const cv::Mat& still, const std::vector<SweptAnimation>& animations);

/// A page of its own: all that it names lies beside it.
/// still   its file's name.
/// size    of the videos, px.
std::string sweep_page(const std::string& title, const std::string& still, cv::Size size,
                       const std::vector<SweptAnimation>& animations);

}  // namespace freshet::tools
