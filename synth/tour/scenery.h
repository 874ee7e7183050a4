// synth/tour/scenery.h — what a tour shows of each frame: the picture on its planes, and things that stand upright.
#pragma once

#include <array>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/tour/texture.h"

namespace freshet::synth::tour {

/// A thing that stands upright and faces the viewer.
struct Upright {
  std::string name;  // for messages
  cv::Mat matte;  // CV_8U, the picture's size: a region (black and white), a trimap (with one grey) or alpha
  double depth = 0;  // units of Room
};

/// Frames of a film taken apart, always in the same way: what was found in the first holds for all.
class Scenery {
 public:
  /// first    CV_32FC3, sRGB code: the first frame. Where things are cut free, their soft edges are found in it, and
  ///          what lies behind them is copied from places near them: those places' fluid moves there too.
  /// Throws   Error{kInput} naming the thing: nothing of it is in the picture, or it and the nearer ones leave nothing.
  /// Cost     without things none; each some seconds at 1280 x 720 (bench/choices/layers.cc).
  Scenery(const cv::Mat& first, std::vector<Upright> things, std::stop_token stop = {});

  /// From now on this frame is shown: CV_8UC3 of the first one's size.
  void show(const cv::Mat& frame);

  struct Board {
    double depth = 0;
    cv::Rect box;                                      // px of the picture that it covers
    bool left = false, right = false, bottom = false;  // the picture cuts it there
    Texture texture;                                   // of the box
    cv::Mat colour, alpha;  // CV_32FC3 times alpha, CV_32F: in the first frame, of the box
  };
  const Texture& ground() const { return ground_; }
  const std::vector<Board>& furthest_first() const { return boards_; }

 private:
  /// Pixels, row by row: the mean of those that the copies here and beside it would bring, so that where two of them
  /// meet nothing jumps, even when their places come to move apart.
  struct Copy {
    int to;
    int count;
    std::array<int, 5> from;
  };
  static std::vector<Copy> copies_of(const cv::Mat& source);
  void carry(const std::vector<Copy>& copies);
  void show_first();

  cv::Mat first_, behind_, change_;  // CV_32FC3
  Texture ground_;
  std::vector<Board> boards_;                     // furthest first
  std::vector<std::vector<Copy>> behind_boards_;  // of each of them
};

}  // namespace freshet::synth::tour
