// synth/tour/film.h — the film, or still, that a tour goes through, for as long as the tour lasts.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "media/video/video_reader.h"

namespace freshet::synth::tour {

/// What follows a film's last frame while the tour goes on.
enum class FilmEnd {
  kRepeat,    // its first, at once where it comes round, else by a cross-fade
  kPingPong,  // the film backwards, and forwards again
  kHold,      // the last stays
};

/// "repeat", "ping-pong", "hold"; Error{kUsage}.
FilmEnd parse_film_end(const std::string& name);

class Film {
 public:
  /// Throws Error{kInput} naming the file, as VideoReader and media::read_still do.
  explicit Film(const std::filesystem::path& path);

  bool is_still() const { return reader_ == nullptr; }
  cv::Size size() const { return first_.size(); }
  double fps() const { return fps_; }  // 0: a still
  /// As its container claims, or counted where it claims nothing; 1: a still.
  int frames();
  /// CV_32FC3, sRGB code: frame 0.
  const cv::Mat& first() const { return first_; }
  /// A still of more than 8 bits.
  bool deep() const { return deep_; }

  /// Before next(): how long it plays. Reads the film once to its end where it may be too short.
  /// frames, fps   of the tour. memory_bytes   for all frames of a film that goes backwards.
  /// Throws        Error{kInput}: more frames than fit; Error{kCancelled}.
  void play(int frames, double fps, FilmEnd end, std::size_t memory_bytes, std::stop_token stop = {});
  /// Of the tour's next frame. CV_8UC3, valid until the next call; null: the one before, or first(), still stands.
  const cv::Mat* next();
  /// For a person.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  struct Length;
  Length read_through(int most, std::vector<cv::Mat>* kept, std::size_t memory_bytes, std::stop_token stop);
  void decode_next();
  void step();

  std::filesystem::path path_;
  cv::Mat first_;
  bool deep_ = false;
  double fps_ = 0, tour_fps_ = 25;
  int claimed_ = 0;
  std::vector<std::string> notices_;

  FilmEnd end_ = FilmEnd::kRepeat;
  std::unique_ptr<media::VideoReader> reader_, before_;  // before_: of the course before, while it fades
  int tour_frame_ = 0, film_frame_ = -1;                 // of the film as it is played
  std::vector<int> courses_;                             // frames of each
  int fade_ = 0;
  std::size_t course_ = 0;
  int place_ = 0;
  bool over_ = false;
  std::vector<cv::Mat> kept_;  // of a film that goes backwards
  cv::Mat frame_;
};

}  // namespace freshet::synth::tour
