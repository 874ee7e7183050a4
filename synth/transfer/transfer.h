// synth/transfer/transfer.h — a designed motion gets the look of an exemplar, frame by frame.
//
// Source  Jamriska, Fiser, Asente, Lu, Shechtman, Sykora 2015, "LazyFluids: Appearance Transfer for Fluid
//         Animations". Sections and equations below are theirs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::transfer {

/// How each target patch gets its source patch.
enum class Retrieval {
  kUniform,  // every source patch of a segment is used K or K + 1 times (Eq. 5)
  kNearest,  // the nearest one, however often: Kwatra et al. 2005, the baseline that washes out
};
/// What a frame begins from, at the coarsest level.
enum class Start {
  kWarped,  // the previous frame carried along the flow; random patches where it left nothing
  kRandom,  // random patches
};
enum class Search {
  kPatchMatch,  // candidates as Barnes et al. 2009: what neighbours have, and chance
  kExact,       // every source with every target: for small pictures and as a test of the other
};

struct TransferOptions {
  int patch = 5;        // px per side, odd, 3 to 9
  double lambda = 0.2;  // 0 to 1: weight of temporal coherence
  double eta = 3;       // 0 to 16: weight of the blurred alpha; less: richer boundaries
  /// Weights, 0 to 16, on eta's scale (Sec. 6 names both guides). They compare the centres of two patches: how the
  /// outline bends there, and how the flow spreads there. The exemplar's flow is that of ExemplarFrame::back.
  double curvature = 0, divergence = 0;
  bool stabilised = false;  // the exemplar, by ExemplarFrame::back
  double radius = 3;        // px, 0.5 to 50: standard deviation of the blur of alpha
  double lower = 0.1;       // blurred alpha from here is the boundary
  double upper = 0.9;       // and from here the interior
  int levels = 0;           // of the pyramid, 1 to 10; 0: as many as leave the shorter side 24 px
  int iterations = 4;  // of retrieval and vote, per level; half at full size where there is a frame before
  int passes = 4;      // of the search, per retrieval
  /// 0 to 4: where patches overlap, one counts as (its distance)^-vote_power. 0.6 is Kwatra et al. 2005;
  /// Wexler et al. 2007 weigh more steeply. At 0.6 a picture and a clip of fire kept 0.59 and 0.61 of their
  /// sharpness (mean squared Laplacian), at 2 0.82 and 0.87.
  double vote_power = 2;
  Retrieval retrieval = Retrieval::kUniform;
  Start start = Start::kWarped;
  Search search = Search::kPatchMatch;
  /// 4: the exemplar also turned by 90, 180 and 270 degrees (Fig. 8). Sec. 4.5 names a search over all angles
  /// for each patch too, and leaves it for its cost: what its authors used is this.
  int quarter_turns = 1;
  double motion_blur = 0;  // 0 to 4: length of the blur along the flow, in frames' motions (Fig. 9)
  std::uint64_t seed = 1;
};

/// Throws Error{kUsage} that names the field and its range.
void check(const TransferOptions& options);

/// Whether ExemplarFrame::back is read.
inline bool needs_motion(const TransferOptions& options) {
  return options.stabilised || options.divergence > 0;
}

/// One moment of the look.
struct ExemplarFrame {
  /// CV_8UC4, CV_16UC4 or CV_32FC4 (0..1), straight alpha; the colour of what is transparent counts for
  /// nothing. Never written to.
  cv::Mat bgra;
  /// CV_32FC2, px, x right, y down: what lies at p lay at p + back in the frame before. Empty: it lay at p.
  /// Read where options ask: `divergence` takes from it how the exemplar spreads. With `stabilised` (Sec. 6) a patch is
  /// compared with where it came from, and goes on from there, so that the design alone moves it; without (Sec. 4.3)
  /// the exemplar's own motion is added to the design's.
  cv::Mat back = {};
};

/// The look at frame t, called from the thread that calls Transfer::next, for t and t - 1. t begins at -1,
/// frame 0's past: give frame 0 again, or the loop's last. A picture gives the same Mat for every t, and is
/// prepared once. All of one size.
using Exemplar = std::function<ExemplarFrame(int t)>;

/// One moment of the design. All frames have one size.
struct TargetFrame {
  cv::Mat alpha;  // CV_8U, or CV_32F 0..1: where the fluid is
  /// CV_32FC2, px per frame, x right, y down: what lies at p now lies at p + flow in the next frame, as
  /// synth/simulate writes it.
  cv::Mat flow;
};

/// How many times source patches were used, by segment.
struct SegmentUse {
  std::int64_t sources = 0, targets = 0;
  std::int64_t min_uses = 0;               // K = targets / sources
  std::int64_t remainder = 0;              // R = targets % sources: so many are used K + 1 times
  std::vector<std::int64_t> sources_used;  // [n]: how many source patches were used n times

  /// Only K and K + 1, and R of the latter.
  bool uniform() const;
};

struct TransferSeconds {  // wall clock, all levels
  double prepare = 0;     // exemplar, segments, warp, pyramids
  double search = 0;      // nearest neighbours
  double assign = 0;      // collisions, order, counts
  double vote = 0;
  double blur = 0;  // along the motion
};

struct TransferredFrame {
  int index = 0;
  cv::Mat bgra;  // CV_32FC4, 0..1, straight alpha, motion blur applied; 0 where alpha is 0
  /// CV_32SC3: the source patch of the patch centred here: x, y of its centre in the exemplar, and quarter
  /// turns of the exemplar, anticlockwise; -1 where there is no patch.
  cv::Mat nearest;
  /// CV_32F: D of Eq. 9 of that pair, and its guides', colours 0..1; 0 where there is no patch.
  cv::Mat distance;
  cv::Mat lambda;  // CV_32F: Eq. 6
  SegmentUse boundary, interior;
  std::int64_t violations =
      0;  // target patches whose source is of the other segment, of an exemplar with both
  double mean_distance = 0;
  std::vector<std::string> remarks;  // what had to be done otherwise than asked, for a person
  TransferSeconds seconds;
};

/// The animation, one frame after the other. A frame depends on the one before: frames cannot be made out of
/// order, but a state can be kept and gone on with.
///
///   Transfer transfer(exemplar, {.seed = 7});
///   for (const TargetFrame& target : design) write(transfer.next(target).bgra);
///
/// Same input and options, same bytes: for any number of threads, and through any save and load.
///
/// Where the exemplar has only one of the two segments (opaque: no boundary; thin: no interior), the target
/// is one segment too, and remarks say so. The alpha of an opaque exemplar's frames is the target's.
class Transfer {
 public:
  /// Throws  Error{kUsage} as check() does.
  Transfer(Exemplar exemplar, const TransferOptions& options);
  Transfer(Transfer&&) noexcept;
  Transfer& operator=(Transfer&&) noexcept;
  ~Transfer();

  /// The next frame. done(fraction) is called from this thread a few times, 0..1; what it throws ends the
  /// frame, and the state is then what it was before.
  /// Throws  Error{kInput}: a type or a size other than said above or than the frame before, flow that is not
  ///         finite, an exemplar smaller than 2 patches per side or with no fluid in it. An empty mask is a
  ///         transparent frame.
  /// Cost    docs/measurements/transfer.md.
  TransferredFrame next(const TargetFrame& target, const std::function<void(double fraction)>& done = {});

  /// Index of the frame that next() makes.
  int frame() const;

  /// Writes everything that the next frame depends on, except the exemplar and the target. Throws Error{kIo};
  /// nothing is left under `path` then.
  void save_state(const std::filesystem::path& path) const;

  /// Throws Error{kInput}: missing, cut, damaged, or written with other options. The state stays as it was.
  void load_state(const std::filesystem::path& path);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::transfer
