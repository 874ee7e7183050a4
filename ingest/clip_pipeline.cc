#include "ingest/clip_pipeline.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "freshet/error.h"
#include "ingest/aside.h"
#include "ingest/clip_analysis.h"
#include "ingest/crossings.h"
#include "media/frame/frame.h"
#include "platform/stopwatch.h"
#include "vision/detail_lifetime.h"
#include "vision/flow.h"
#include "vision/textureness.h"

namespace freshet::ingest {
namespace {

struct Slab {
  std::vector<media::Frame> frames;
  std::vector<cv::Mat> luma;  // CV_8U
};

Slab decode_slab(const FrameSource& next, double& seconds) {
  const TimedScope watch(seconds);
  Slab slab;
  slab.frames.reserve(kSlab);
  slab.luma.reserve(kSlab);
  while (slab.frames.size() < kSlab) {
    std::optional<media::Frame> frame = next();
    if (!frame) break;
    slab.luma.push_back(media::to_luma(*frame));
    slab.frames.push_back(std::move(*frame));
  }
  return slab;
}

std::vector<store::PlaneShape> shapes_of(const media::Frame& frame) {
  std::vector<store::PlaneShape> shapes;
  for (const media::Plane& plane : frame.planes) {
    shapes.push_back({static_cast<std::uint32_t>(plane.width), static_cast<std::uint32_t>(plane.height),
                      static_cast<std::uint8_t>(plane.bytes_per_sample)});
  }
  return shapes;
}

store::PlaneView view_of(const cv::Mat& plane) {
  return {reinterpret_cast<const std::byte*>(plane.data), static_cast<std::ptrdiff_t>(plane.step)};
}

/// All that is kept of a clip while its frames go by.
struct Pass {
  const vision::Settings& settings;
  const double fps;
  store::ClipWriter& writer;
  IngestSeconds& seconds;
  Screener screener;
  CrossingFinder crossings;
  vision::LoopFinder loop;
  LumaStatistics statistics;
  vision::MotionAccumulator motion;
  vision::DetailLifetimeAccumulator life;
  std::vector<std::unique_ptr<vision::TexturenessAccumulator>> texture;
  cv::Mat previous;  // the last luma of the slab before, and its time
  double previous_s = 0;
  std::vector<double> rates;  // of all pairs
  bool flow_begun = false;
  std::vector<cv::Mat> u = std::vector<cv::Mat>(kSlab), v = std::vector<cv::Mat>(kSlab);
  std::vector<store::PlaneView> views;

  Pass(cv::Size size, double fps_, const vision::Settings& settings_, store::ClipWriter& writer_,
       IngestSeconds& seconds_)
      : settings(settings_),
        fps(fps_),
        writer(writer_),
        seconds(seconds_),
        screener(size, fps),
        crossings(size, fps),
        loop(fps),
        statistics(size),
        motion(size, settings_.flow_step, fps, settings_.spectrum),
        life(size, settings_.flow_step, fps) {
    for (const float scale : settings.scales) {
      texture.push_back(std::make_unique<vision::TexturenessAccumulator>(size, scale, settings.texture_cell));
    }
  }

  void add(const Slab& slab) {
    {
      // Screening, the loop and what crosses take frames one after another: one thread, beside the flow of the
      // same frames.
      Aside screening([&] {
        const TimedScope watch(seconds.screen);
        for (const cv::Mat& luma : slab.luma) {
          screener.add(luma);
          crossings.add(luma);
          loop.add(luma);
        }
      });
      add_flow(slab);
      screening.wait();
    }
    {
      // Tracks go from frame to frame: one thread, beside the textureness of the same frames.
      Aside lives([&] {
        const TimedScope watch(seconds.life);
        add_life(slab);
      });
      const TimedScope watch(seconds.texture);
      for (const cv::Mat& luma : slab.luma) {
        statistics.add(luma);
        for (const auto& scale : texture) scale->add(luma);
      }
      lives.wait();
    }
    {
      const TimedScope watch(seconds.store);
      views.clear();
      for (const media::Frame& frame : slab.frames) {
        for (const media::Plane& plane : frame.planes) views.push_back({plane.data, plane.stride});
      }
      writer.append(store::Stream::kFrames, views);
    }
    previous = slab.luma.back();
    previous_s = slab.frames.back().time_s;
  }

  void add_life(const Slab& slab) {
    for (std::size_t i = 0; i < slab.luma.size(); ++i) {
      if (i == 0 && previous.empty())
        life.begin(slab.luma[i]);
      else
        life.add(u[i], v[i], slab.luma[i]);
    }
  }

  /// The flow of frames that lie further apart, or less far, than the clip's others, as it would be at the clip's rate.
  void add_motion(const cv::Mat& along, const cv::Mat& down, double times) {
    if (times == 1) return motion.add(along, down);
    cv::Mat scaled_u, scaled_v;
    along.convertTo(scaled_u, along.type(), times);
    down.convertTo(scaled_v, down.type(), times);
    motion.add(scaled_u, scaled_v);
  }

  void add_flow(const Slab& slab) {
    const int first = previous.empty() ? 1 : 0;  // the clip's first frame has none before it
    const int last = static_cast<int>(slab.luma.size());
    if (first >= last) return;
    {
      const TimedScope watch(seconds.flow);
      tbb::parallel_for(first, last, [&](int i) {
        const cv::Mat& from = i == 0 ? previous : slab.luma[i - 1];
        const cv::Mat flow = vision::optical_flow(from, slab.luma[i], settings.flow);
        vision::quantize_flow(flow, settings.flow_step, u[i], v[i]);
      });
    }
    {
      const TimedScope watch(seconds.motion);
      for (int i = first; i < last; ++i) {
        const double before_s = i == 0 ? previous_s : slab.frames[i - 1].time_s;
        rates.push_back(pair_rate(slab.frames[i].time_s - before_s, fps));
        add_motion(u[i], v[i], rates.back() / fps);
      }
    }
    const TimedScope watch(seconds.store);
    if (!std::exchange(flow_begun, true)) {
      const store::PlaneShape shape{static_cast<std::uint32_t>(u[first].cols),
                                    static_cast<std::uint32_t>(u[first].rows), 2};
      writer.begin_stream(store::Stream::kFlow, std::vector{shape, shape});
    }
    views.clear();
    for (int i = first; i < last; ++i) {
      views.push_back(view_of(u[i]));
      views.push_back(view_of(v[i]));
    }
    writer.append(store::Stream::kFlow, views);
  }
};

}  // namespace

ClipMeasures stream_clip(const FrameSource& next, double fps, const std::string& where,
                         const vision::Settings& settings, store::ClipWriter& writer,
                         const std::function<void(std::uint32_t)>& on_slab, const std::stop_token& stop,
                         IngestSeconds& seconds) {
  Slab slab = decode_slab(next, seconds.decode);
  if (slab.frames.empty())
    throw Error(ErrorKind::kInput, where, "not one frame could be decoded", "Check that the file plays");
  const cv::Size size = slab.luma.front().size();
  writer.begin_stream(store::Stream::kFrames, shapes_of(slab.frames.front()));

  ClipMeasures measures;
  Pass pass(size, fps, settings, writer, seconds);
  while (!slab.frames.empty()) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, where, "stopped; the clip was not added");
    Slab following;
    Aside decoding([&] { following = decode_slab(next, seconds.decode); });
    for (const media::Frame& frame : slab.frames) measures.columns.times_s.push_back(frame.time_s);
    pass.add(slab);
    measures.frames += static_cast<std::uint32_t>(slab.frames.size());
    on_slab(measures.frames);
    decoding.wait();
    slab = std::move(following);
  }
  if (measures.frames < kMinAnalysedFrames) {
    throw Error(ErrorKind::kInput, where,
                fmt::format("only {} frame{}, at least {} are needed to measure motion", measures.frames,
                            measures.frames == 1 ? "" : "s", kMinAnalysedFrames),
                "Give a longer clip");
  }

  const TimedScope watch(seconds.patches);
  measures.screening = pass.screener.finish();
  measures.screening.timing = timing_of(measures.columns.times_s);
  if (!measures.screening.timing.steady) measures.columns.rates = std::move(pass.rates);
  measures.loop = pass.loop.finish();
  measures.columns.average = pass.statistics.mean_u16();
  measures.moving = moving_mask(pass.motion.mean_speed_px(), pass.statistics.deviation(), fps, settings);
  measures.crossed = pass.crossings.finish();
  const auto pixels = static_cast<double>(measures.moving.total());
  measures.screening.static_fraction = 1 - cv::countNonZero(measures.moving) / pixels;
  if (!measures.crossed.empty()) {
    measures.moving.setTo(0, measures.crossed);
    measures.screening.crossed_fraction = cv::countNonZero(measures.crossed) / pixels;
  }
  measures.columns.motion = pass.motion.finish();
  for (const auto& scale : pass.texture) measures.columns.texture.push_back(scale->finish());
  vision::DetailLifetimes life = pass.life.finish(measures.moving);
  measures.columns.life = std::move(life.cells);
  measures.columns.standing = std::move(life.standing);
  measures.columns.layout = std::move(life.layout);
  measures.columns.flow_outliers = std::move(life.flow_outliers);
  measures.half_life_s = life.clip;
  measures.standing = life.clip_standing;
  return measures;
}

}  // namespace freshet::ingest
