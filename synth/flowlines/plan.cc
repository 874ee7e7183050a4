#include "synth/flowlines/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

constexpr std::array<double, 4> kWays{0.5, 0.4, 0.3, 0.2};  // shares of the frames for particles' ways
constexpr int kMostLoop = 10000;  // frames: the order of a loop is searched for as a whole

constexpr std::uint64_t kSeedsApart = 7919;
constexpr double kTurn =
    0.382;  // of a round, between times: the golden section keeps any number of them apart

RepeatOptions repeats_of(const PlanOptions& options, std::size_t stream) {
  return {.in_turn = options.in_turn, .seed = options.seed * 1000 + stream};
}

/// All streams' ladders; price: what their discontinuities weigh together, by area.
std::vector<Ladder> ladders_of(const Ladders& ladders, const Plan& plan, int frames,
                               const PlanOptions& options, double& price) {
  std::vector<Ladder> made;
  for (std::size_t k = 0; k < plan.arrivals.streams.size(); ++k) {
    const Stream& stream = plan.arrivals.streams[k];
    const int room = frames - 2 * plan.margin - static_cast<int>(std::ceil(stream.duration));
    const cv::Mat where = plan.arrivals.stream == static_cast<double>(k);
    made.push_back(ladders.of(stream, where, plan.margin, options.entries > 0 ? options.entries : room,
                              repeats_of(options, k)));
    // Particles that a rung cuts are discontinuities too; and a rung that is through soon is seen all at once.
    const double together = made[k].jump / (static_cast<double>(stream.duration) + 2 * plan.margin);
    price += cv::countNonZero(where) * (made[k].per_frame * (1 + plan.cut_share) + 0.5 * together);
  }
  return made;
}

/// lead    frames by which it is further on.
Order order_of(const Plan& plan, std::size_t stream, const PlanOptions& options, int lead) {
  const Ladder& ladder = plan.ladders[stream];
  RepeatOptions repeats = repeats_of(options, stream);
  repeats.min_run = ladder.min_run;
  repeats.fade = ladder.fade;
  if (options.loop_frames == 0)
    return {ladder, repeats,
            static_cast<int>(plan.arrivals.streams[stream].duration) + 2 * plan.margin + 4 + lead};
  std::vector<Run> period = cyclic(ladder.cost, options.loop_frames, repeats);
  if (period.empty() && options.in_turn)
    throw Error(ErrorKind::kUsage, fmt::format("--loop --frames {}", options.loop_frames),
                fmt::format("{} entries repeat in turn, which do not divide it", ladder.entries()),
                "Give --entries a number that does, or leave --repeats in-turn out");
  if (period.empty()) {
    int longest = 0;
    for (const Ladder& other : plan.ladders) longest = std::max(longest, other.min_run);
    throw Error(ErrorKind::kUsage, fmt::format("--loop --frames {}", options.loop_frames),
                "no order of repeats is that short",
                fmt::format("Ask for {} frames or more", 2 * longest + 2));
  }
  return {ladder, std::move(period), options.loop_frames, lead};
}

}  // namespace

Plan plan_repeats(const Ladders& ladders, const std::vector<FlowLine>& lines, const Rides& rides,
                  cv::Size picture, int frames, const PlanOptions& options, const Job& job) {
  const int margin = std::clamp(frames / 10, kLeastMargin, 8), room = frames - 2 * margin;
  if (options.entries > room - 2)
    throw Error(ErrorKind::kUsage, fmt::format("--entries {}", options.entries),
                fmt::format("of the clip's {} frames at most {} can be repeated", frames, room - 2),
                "Ask for fewer, or give a longer clip");
  if (options.loop_frames > kMostLoop)
    throw Error(ErrorKind::kUsage, fmt::format("--loop --frames {}", options.loop_frames),
                fmt::format("a loop has {} frames at most", kMostLoop),
                "Ask for fewer, and play it again and again; without --loop there may be any number");
  std::vector<int> ways;
  for (const double share : kWays) ways.push_back(cvRound(share * room));
  if (options.entries > 0) ways.assign(1, room - options.entries);
  Plan best;
  double least = 0;
  for (std::size_t w = 0; w < ways.size(); ++w) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "repeats", "stopped");
    if (job.progress) job.progress({"planning repeats", w, ways.size()});
    Plan tried;
    tried.margin = margin;
    tried.floor = floor_for(lines, rides, options.strands, static_cast<float>(ways[w]));
    tried.cut_share = share_below(rides, tried.floor);
    tried.arrivals = arrivals(lines, rides, picture, options.strands, tried.floor, false);
    double price = 0;
    tried.ladders = ladders_of(ladders, tried, frames, options, price);
    if (!best.ladders.empty() && price >= least) continue;
    least = price;
    best = std::move(tried);
  }
  if (!rides.stationary) best.arrivals = arrivals(lines, rides, picture, options.strands, best.floor, true);
  return best;
}

std::vector<Order> orders_of(const Plan& plan, const PlanOptions& options, int time) {
  PlanOptions own = options;
  own.seed += static_cast<std::uint64_t>(time) * kSeedsApart;
  // All streams as much further on, so that they stay together.
  const int round = options.loop_frames > 0 ? options.loop_frames : plan.ladders.front().entries();
  const double turn = time * kTurn;
  const int lead = cvRound((turn - std::floor(turn)) * round);
  std::vector<Order> orders;
  for (std::size_t k = 0; k < plan.ladders.size(); ++k) orders.push_back(order_of(plan, k, own, lead));
  return orders;
}

}  // namespace freshet::synth::flowlines
