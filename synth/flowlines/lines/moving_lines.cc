#include "synth/flowlines/lines/moving_lines.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

double time_of(const FlowLine& line) { return static_cast<double>(line.time_s.value_or(0)); }

void check(const std::vector<FlowLine>& positions, double loop_s, const std::string& where) {
  const auto fail = [&](const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kInput, fmt::format("{}: \"{}\"", where, positions.front().name), fault, remedy);
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions.size() > 1 && !positions[i].time_s)
      fail("one of its positions has no time", "Give each its data-time, in seconds");
    if (i > 0 && time_of(positions[i]) <= time_of(positions[i - 1]))
      fail(fmt::format("it has two positions at {:.6g} s", time_of(positions[i])),
           "Give each a time of its own");
    if (loop_s > 0 && time_of(positions[i]) >= loop_s)
      fail(fmt::format("it has a position at {:.6g} s, and the loop ends at {:.6g} s", time_of(positions[i]),
                       loop_s),
           "Ask for more --frames, or move it earlier; from the last position a line goes back to the first");
  }
}

}  // namespace

MovingLines::MovingLines(const std::vector<FlowLine>& lines, double loop_s, const std::string& where)
    : loop_s_(loop_s) {
  for (const FlowLine& line : lines) {
    const auto known = std::find_if(positions_.begin(), positions_.end(),
                                    [&](const auto& of) { return of.front().name == line.name; });
    if (known == positions_.end())
      positions_.push_back({line});
    else
      known->push_back(line);
  }
  for (std::vector<FlowLine>& positions : positions_) {
    std::stable_sort(positions.begin(), positions.end(),
                     [](const FlowLine& a, const FlowLine& b) { return time_of(a) < time_of(b); });
    check(positions, loop_s, where);
  }
}

bool MovingLines::moves() const {
  return std::any_of(positions_.begin(), positions_.end(), [](const auto& of) { return of.size() > 1; });
}

std::vector<FlowLine> MovingLines::at(double seconds) const {
  const double time = loop_s_ > 0 ? seconds - loop_s_ * std::floor(seconds / loop_s_) : seconds;
  std::vector<FlowLine> out;
  for (const std::vector<FlowLine>& positions : positions_) {
    const auto after = std::find_if(positions.begin(), positions.end(),
                                    [&](const FlowLine& line) { return time_of(line) > time; });
    const bool ends = after == positions.begin() || after == positions.end();
    if (positions.size() == 1 || (ends && loop_s_ <= 0)) {
      out.push_back(after == positions.begin() ? positions.front() : positions.back());
      continue;
    }
    const FlowLine &from = ends ? positions.back() : *(after - 1), &to = ends ? positions.front() : *after;
    const double length = time_of(to) - time_of(from) + (ends ? loop_s_ : 0);
    const double gone = time - time_of(from) + (ends && time < time_of(from) ? loop_s_ : 0);
    out.push_back(between(from, to, static_cast<float>(gone / length)));
  }
  return out;
}

FlowLine between(const FlowLine& from, const FlowLine& to, float share) {
  const int points = std::max(from.samples(), to.samples());
  std::vector<cv::Point2f> chain;
  for (int i = 0; i < points; ++i) {
    const float along = static_cast<float>(i) / static_cast<float>(points - 1);
    chain.push_back(at(from, along * from.length()) * (1 - share) + at(to, along * to.length()) * share);
  }
  FlowLine line = evenly(chain, to.name);
  const std::size_t speeds = std::max(from.speeds.size(), to.speeds.size());
  for (std::size_t i = 0; i < speeds; ++i) {
    const float along = speeds == 1 ? 0.0f : static_cast<float>(i) / static_cast<float>(speeds - 1);
    line.speeds.push_back(speed_at(from, along * from.length()) * (1 - share) +
                          speed_at(to, along * to.length()) * share);
  }
  return line;
}

}  // namespace freshet::synth::flowlines
