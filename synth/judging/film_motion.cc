#include "synth/judging/film_motion.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

#include "synth/judging/reading.h"
#include "vision/flow.h"

namespace freshet::synth::judging {

FilmMotion film_motion(const Evidence& film) {
  const int frames = film.count(), pairs = std::min(kRunPairs, frames / kSpans);
  FilmMotion motion;
  struct Job {
    std::size_t run;
    int pair;
  };
  std::vector<Job> jobs;
  for (int span = 0; span < kSpans; ++span) {
    const int middle = (2 * span + 1) * frames / (2 * kSpans);
    MotionRun& run = motion.runs.emplace_back();
    run.first = std::clamp(middle - pairs / 2, 0, frames - 1 - pairs);
    run.flow.resize(static_cast<std::size_t>(pairs));
    for (int i = 0; i < pairs; ++i) jobs.push_back({motion.runs.size() - 1, i});
  }
  oneapi::tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
    MotionRun& run = motion.runs[jobs[i].run];
    const auto from = static_cast<std::size_t>(run.first + jobs[i].pair);
    run.flow[static_cast<std::size_t>(jobs[i].pair)] =
        vision::optical_flow(film.luma()[from], film.luma()[from + 1]);
  });
  motion.mean = cv::Mat::zeros(film.size(), CV_32FC2);
  motion.speed = cv::Mat::zeros(film.size(), CV_32F);
  for (const MotionRun& run : motion.runs)
    for (const cv::Mat& flow : run.flow) {
      motion.mean += flow;
      std::vector<cv::Mat> parts;
      cv::split(flow, parts);
      cv::Mat speed;
      cv::magnitude(parts[0], parts[1], speed);
      motion.speed += speed;
    }
  const double per_second = film.fps() / static_cast<double>(std::max<std::size_t>(1, jobs.size()));
  motion.mean *= per_second;
  motion.speed *= per_second;
  return motion;
}

}  // namespace freshet::synth::judging
