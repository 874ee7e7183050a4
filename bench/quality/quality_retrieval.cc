#include "bench/quality/quality_retrieval.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace freshet::bench {
namespace {

// Of what there is.
class Average {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    sum_ += value;
    ++count_;
  }
  double value() const {
    return count_ > 0 ? sum_ / static_cast<double>(count_) : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

}  // namespace

Retrieval retrieval_of(const query::Target& target, const stored::PatchTable& table,
                       std::span<const std::vector<stored::Row>> rows, const std::vector<bool>& same_class,
                       const cv::Mat& motion, const cv::Mat& matte) {
  Average same, angle, speed;
  const cv::Mat moving = matte > 127;
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const cv::Rect area =
        cv::Rect(target.corners[piece], cv::Size(target.side, target.side)) & cv::Rect({}, motion.size());
    const cv::Scalar mean = cv::mean(motion(area), moving(area));
    const double truth = std::hypot(mean[0], mean[1]);
    Average of_class, turned, faster;
    for (const stored::Row row : rows[piece]) {
      of_class.add(same_class[table.clip[row]] ? 1 : 0);
      const double u = table.mean_u[row], v = table.mean_v[row], own = std::hypot(u, v);
      if (truth < kMoves || own < kMoves) continue;
      turned.add(std::acos(std::clamp((u * mean[0] + v * mean[1]) / (own * truth), -1.0, 1.0)) * 180 / CV_PI);
      faster.add(std::abs(std::log2(own / truth)));
    }
    same.add(of_class.value());
    angle.add(turned.value());
    speed.add(faster.value());
  }
  return {same.value(), angle.value(), speed.value()};
}

std::string retrieval_table(std::span<const RetrievedCase> cases) {
  Average likeness, figures[2][3];
  double cpu_s = 0;
  std::size_t pieces = 0;
  for (const RetrievedCase& one : cases) {
    likeness.add(one.likeness);
    for (int i = 0; i < 2; ++i) {
      const Retrieval& found = i == 0 ? one.best : one.labels;
      figures[i][0].add(found.same_class);
      figures[i][1].add(found.angle_deg);
      figures[i][2].add(found.speed);
    }
    cpu_s += one.search_cpu_s;
    pieces += one.pieces;
  }
  std::string text = fmt::format(
      "\nwhat looks alone tell, of {} stills: the best patch is {:.3f} alike; {:.2f} ms of CPU a piece\n\n"
      "| patches | of the class | angle deg | speed log2 |\n| --- | --- | --- | --- |\n",
      cases.size(), likeness.value(), 1e3 * cpu_s / static_cast<double>(std::max<std::size_t>(1, pieces)));
  const char* const names[] = {"candidates", "labels"};
  for (int i = 0; i < 2; ++i)
    text += fmt::format("| {} | {:.3f} | {:.1f} | {:.2f} |\n", names[i], figures[i][0].value(),
                        figures[i][1].value(), figures[i][2].value());
  return text;
}

}  // namespace freshet::bench
