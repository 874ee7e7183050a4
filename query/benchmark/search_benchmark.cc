#include "query/benchmark/search_benchmark.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "query/benchmark/subset_index.h"
#include "query/index/exact_index.h"
#include "query/labelling/labelling.h"
#include "query/search/picture_scale.h"
#include "report/machine.h"

namespace freshet::query {
namespace {

constexpr std::size_t kBest = 100;
constexpr std::size_t kMinPieces = 10, kFilteredPieces = 40;

using oneapi::tbb::global_control;

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

std::size_t free_memory() {
  return static_cast<std::size_t>(sysconf(_SC_AVPHYS_PAGES)) *
         static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::vector<ScoredPatch> brute_force(const SearchSpace& space, const PieceQuery& piece) {
  std::vector<ScoredPatch> scored_patches(space.words.size());
  for (std::size_t row = 0; row < scored_patches.size(); ++row)
    scored_patches[row] = {static_cast<stored::Row>(row),
                           static_cast<std::uint32_t>(vision::intersection(piece.words, space.words[row],
                                                                           space.word_count, &piece.mask))};
  const std::size_t k = std::min(kBest, scored_patches.size());
  std::partial_sort(scored_patches.begin(), scored_patches.begin() + static_cast<std::ptrdiff_t>(k),
                    scored_patches.end(), better);
  scored_patches.resize(k);
  return scored_patches;
}

// Some rows of the table and what is true of them.
struct Ground {
  std::vector<stored::Row> rows;
  vision::OwnWordMaps words;
  SearchSpace space;
  std::unique_ptr<const ExactIndex> index;
  std::vector<std::vector<ScoredPatch>> exact;  // of all queries
  std::optional<double> energy;                 // of the picture labelled with exact candidates
};

// One condition on patches, and what it is in a ground's own numbers.
struct Condition {
  std::string name;
  std::optional<RowFilter> rows;      // of the table
  std::vector<MotionWindow> windows;  // one per query
};

class BorrowedIndex final : public CandidateIndex {
 public:
  explicit BorrowedIndex(const CandidateIndex& index) : index_(index) {}
  std::size_t rows() const override { return index_.rows(); }
  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    return index_.search(queries, k, search_filter);
  }

 private:
  const CandidateIndex& index_;
};

// A search base answers from another index for a while; its own comes back, whatever is thrown meanwhile.
class LentIndex {
 public:
  LentIndex(SearchBase& base, const CandidateIndex& index)
      : base_(base), own_(std::exchange(base.index, std::make_unique<BorrowedIndex>(index))) {}
  ~LentIndex() { base_.index = std::move(own_); }
  LentIndex(const LentIndex&) = delete;
  LentIndex& operator=(const LentIndex&) = delete;

 private:
  SearchBase& base_;
  std::unique_ptr<const CandidateIndex> own_;
};

class Benchmark {
 public:
  Benchmark(const store::Snapshot& snapshot, SearchBase& base, std::vector<BenchmarkPicture> pictures,
            const SearchBenchmarkOptions& options, const std::function<void(const std::string&)>& progress,
            std::stop_token stop)
      : snapshot_(snapshot),
        base_(base),
        options_(options),
        progress_(progress),
        stop_(std::move(stop)),
        asked_(benchmark_pieces(snapshot, base, std::move(pictures), options.pieces, options.rows)) {
    if (options_.max_bytes == 0) options_.max_bytes = free_memory() / 5 * 4;
  }

  SearchReport run(std::span<const MeasuredIndex> indexes) {
    SearchReport report;
    report.machine = report::this_machine();
    report.store = snapshot_.path().filename().string();
    report.clips = base_.table.clips.size();
    report.patches = base_.table.size();
    report.rows = asked_.rows.size();
    report.words = base_.codebook.words;
    report.held_out = asked_.held_out;
    for (const BenchmarkPicture& picture : asked_.pictures) report.pictures.push_back(picture.name);
    report.picture_pieces = asked_.pieces;
    report.pieces = asked_.queries.size();
    report.build_limit_s = options_.build_limit_s;
    report.setting_limit_s = options_.setting_limit_s;
    if (options_.label) {
      crop_labelled();
      report.labelled = asked_.pictures[0].name;
      report.labelled_pieces = labelled_pieces_;
    }

    say("the exact answers");
    const Ground& all = ground(asked_.rows.size());
    report.checked = std::min(options_.checked, asked_.queries.size());
    report.wrong = compare_with_brute_force(all, report.checked);
    if (options_.filters) make_conditions();
    for (const MeasuredIndex& index : indexes) report.indexes.push_back(measure(index));
    return report;
  }

 private:
  void say(const std::string& what) {
    if (stop_.stop_requested()) throw Error(ErrorKind::kCancelled, "search benchmark", "stopped");
    if (progress_) progress_(what);
  }

  Ground& ground(std::size_t count) {
    Ground& ground = grounds_[count];
    if (ground.index) return ground;
    ground.rows = evenly(asked_.rows, count);
    ground.words = vision::rows_of(base_.table.words, ground.rows);
    ground.space = {ground.words, base_.codebook.words};
    ground.index = std::make_unique<ExactIndex>(ground.words, base_.codebook.words);
    ground.exact = ground.index->search(asked_.queries, kBest);
    return ground;
  }

  std::size_t compare_with_brute_force(const Ground& ground, std::size_t count) const {
    std::atomic<std::size_t> wrong = 0;
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const std::size_t piece = i * asked_.queries.size() / count;
      wrong += ground.exact[piece] != brute_force(ground.space, asked_.queries[piece]);
    });
    return wrong;
  }

  // The class that is nearest to a quarter of the patches, and the direction nearest to a sixth; and one
  // clip.
  void make_conditions() {
    const stored::PatchTable& table = base_.table;
    const auto total = static_cast<double>(table.size());
    std::map<std::string, double> classes;
    for (std::size_t c = 0; c < table.clips.size(); ++c)
      classes[snapshot_.clip(table.clips[c]).class_name] +=
          (table.first_row[c + 1] - table.first_row[c]) / total;
    const auto chosen = std::min_element(classes.begin(), classes.end(), [](const auto& a, const auto& b) {
      return std::abs(a.second - 0.25) < std::abs(b.second - 0.25);
    });
    if (chosen->second < 1) {
      Condition condition{"class " + chosen->first, RowFilter(table.size()), {}};
      for (stored::Row row = 0; row < table.size(); ++row)
        if (snapshot_.clip(table.clips[table.clip[row]]).class_name != chosen->first)
          condition.rows->forbid(row);
      conditions_.push_back(std::move(condition));
    }
    struct Direction {
      double degrees = 0, fraction = 0;
      MotionWindow window;
    };
    std::vector<Direction> directions;
    for (int eighth = 0; eighth < 8; ++eighth) {
      const double angle = eighth * std::numbers::pi / 4;
      Direction direction{eighth * 45.0, 0, {}};
      direction.window.u = static_cast<float>(std::cos(angle));
      direction.window.v = static_cast<float>(-std::sin(angle));
      direction.window.min_cosine = static_cast<float>(std::cos(std::numbers::pi / 6));
      direction.window.min_speed = 2.5F;
      for (stored::Row row = 0; row < table.size(); ++row)
        direction.fraction += direction.window.admits(table.mean_u[row], table.mean_v[row]) / total;
      directions.push_back(direction);
    }
    const auto best =
        std::min_element(directions.begin(), directions.end(), [](const auto& a, const auto& b) {
          return std::abs(a.fraction - 1.0 / 6) < std::abs(b.fraction - 1.0 / 6);
        });
    if (best->fraction > 0)
      conditions_.push_back({fmt::format("direction {:g} +- 30 degrees", best->degrees),
                             {},
                             std::vector(asked_.queries.size(), best->window)});
    const std::uint32_t clip = table.clip[asked_.rows[asked_.rows.size() / 2]];
    Condition one{"clip " + snapshot_.clip(table.clips[clip]).name, RowFilter(table.size(), false), {}};
    for (stored::Row row = table.first_row[clip]; row < table.first_row[clip + 1]; ++row)
      one.rows->allow(row);
    conditions_.push_back(std::move(one));
  }

  IndexResult measure(const MeasuredIndex& kind) {
    IndexResult result;
    result.name = kind.name;
    result.what = kind.what;
    result.is_exact = kind.is_exact;
    if (!kind.build) {
      result.skipped = fmt::format("Freshet was built without {}", kind.package);
      result.package = kind.package;
      return result;
    }
    try {
      say(kind.name + ": building");
      const BuiltIndex built = build(kind, result);
      Ground& on = ground(result.rows);
      for (const IndexSetting& setting : built.settings) {
        say(fmt::format("{}: {}", kind.name, setting.name));
        setting.apply();
        result.settings.push_back(measure(setting.name, *built.index, on));
        SettingResult& measured = result.settings.back();
        if (options_.label && !kind.is_exact) measured.energy_loss = loss_of(*built.index, on, measured);
        if (options_.label && kind.is_exact) measured.energy_loss = 0;
      }
      if (options_.filters) measure_filters(built, on, result);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::kCancelled) throw;
      result.skipped = error.what();
      result.settings.clear();
    } catch (const std::bad_alloc&) {
      result.skipped = "not enough memory";
      result.settings.clear();
    }
    return result;
  }

  struct Cost {
    double seconds = 0, bytes = 0;
  };
  Cost build_once(const MeasuredIndex& kind, const SearchSpace& space, BuiltIndex& built) {
    const global_control one(global_control::max_allowed_parallelism, 1);
    const std::size_t before = report::allocated_bytes();
    const double start = report::thread_seconds();
    built = kind.build(space);
    const double seconds = report::thread_seconds() - start;
    const std::size_t after = report::allocated_bytes();
    return {seconds, static_cast<double>(after > before ? after - before : 0)};
  }

  // Of as many rows as the limits allow.
  BuiltIndex build(const MeasuredIndex& kind, IndexResult& result) {
    const std::size_t all = asked_.rows.size();
    BuiltIndex built;
    if (kind.load && all == base_.table.size()) {
      const std::size_t before = report::allocated_bytes();
      if (auto loaded = kind.load(ground(all).space, snapshot_)) {
        result.rows = all;
        result.from_store = true;
        result.bytes = report::allocated_bytes() - before;
        result.build_seconds = loaded->build_seconds.value_or(0);
        return *std::move(loaded);
      }
    }
    const auto try_part = [&](std::size_t rows) {
      const std::vector<stored::Row> some = evenly(asked_.rows, rows);
      const vision::OwnWordMaps words = vision::rows_of(base_.table.words, some);
      const Cost cost = build_once(kind, {words, base_.codebook.words}, built);
      built = {};
      return cost;
    };
    std::size_t rows = all;
    if (all >= 8 * options_.min_rows) {
      const std::size_t first = std::max<std::size_t>(1, all / 32), second = all / 8;
      const Cost small = try_part(first);
      double predicted = small.seconds * std::pow(32, 1.5), exponent = 1.5, bytes = 32 * small.bytes;
      if (predicted > options_.build_limit_s) {
        // Even this part may be too much: an eighth costs up to eight times a 32nd.
        if (8 * small.seconds <= options_.build_limit_s) {
          const Cost larger = try_part(second);
          exponent =
              std::clamp(std::log(larger.seconds / std::max(small.seconds, 1e-6)) / std::log(4.0), 1.0, 2.0);
          predicted = larger.seconds * std::pow(8.0, exponent);
          bytes = 8 * larger.bytes;
        }
        if (predicted > options_.build_limit_s) {
          const double fraction = std::pow(options_.build_limit_s / predicted, 1 / exponent);
          rows = std::max(first, static_cast<std::size_t>(fraction * static_cast<double>(all)));
          result.projected_build_seconds = predicted;
        }
      }
      // While it is built, an index may hold its input a second time.
      if (const auto max_bytes = static_cast<double>(options_.max_bytes); 1.5 * bytes > max_bytes)
        rows = std::min(rows, static_cast<std::size_t>(max_bytes / (1.5 * bytes) * static_cast<double>(all)));
      if (rows < all && result.projected_build_seconds == 0) result.projected_build_seconds = predicted;
      if (rows < options_.min_rows)
        throw Error(
            ErrorKind::kUsage, kind.name,
            fmt::format("even {} patches would pass the limits of {:g} s and {:.1f} GB", options_.min_rows,
                        options_.build_limit_s, static_cast<double>(options_.max_bytes) / 1e9));
    }
    say(fmt::format("{}: building from {} patches", kind.name, rows));
    result.rows = rows;
    const Cost cost = build_once(kind, ground(rows).space, built);
    result.build_seconds = cost.seconds;
    result.bytes = static_cast<std::size_t>(cost.bytes);
    return built;
  }

  // One by one on one core until the time is up; then those pieces again at once on all threads.
  SearchTimes time(const CandidateIndex& index, std::span<const PieceQuery> queries,
                   const SearchFilter& search_filter, std::vector<std::vector<ScoredPatch>>& answers) {
    SearchTimes times;
    std::vector<double> ms;
    {
      const global_control one(global_control::max_allowed_parallelism, 1);
      double total = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        if (i >= kMinPieces && total > options_.setting_limit_s) break;
        SearchFilter own = search_filter;
        if (!own.windows.empty()) own.windows = own.windows.subspan(i, 1);
        // The first once more before: code and memory are warm.
        if (i == 0) index.search(queries.subspan(0, 1), kBest, own);
        const double start = report::thread_seconds();
        auto answer = index.search(queries.subspan(i, 1), kBest, own);
        const double seconds = report::thread_seconds() - start;
        answers.push_back(std::move(answer[0]));
        ms.push_back(1e3 * seconds);
        total += seconds;
        if (stop_.stop_requested()) say("");
      }
    }
    times.median_ms = quantile(ms, 0.5);
    times.p99_ms = quantile(ms, 0.99);
    SearchFilter own = search_filter;
    if (!own.windows.empty()) own.windows = own.windows.first(ms.size());
    std::vector<double> rounds;
    double spent = 0;
    while (rounds.empty() || (rounds.size() < 3 && spent < options_.setting_limit_s / 2)) {
      const double start = report::wall_seconds();
      index.search(queries.first(ms.size()), kBest, own);
      spent += report::wall_seconds() - start;
      rounds.push_back(1e3 * (report::wall_seconds() - start) / static_cast<double>(ms.size()));
    }
    times.all_threads_ms = quantile(rounds, 0.5);
    return times;
  }

  SettingResult measure(const std::string& name, const CandidateIndex& index, const Ground& on) {
    SettingResult result;
    result.name = name;
    std::vector<std::vector<ScoredPatch>> answers;
    result.times = time(index, asked_.queries, {}, answers);
    result.pieces = answers.size();
    result.recall = recall_of(answers, std::span(on.exact).first(answers.size()),
                              std::span(asked_.queries).first(answers.size()), on.space);
    return result;
  }

  // Around the middle of the matte, so much of the picture that there are about as many pieces as wanted.
  void crop_labelled() {
    labelled_ = asked_.pictures[0];
    const double fraction =
        std::sqrt(static_cast<double>(options_.labelled_pieces) / static_cast<double>(asked_.pieces[0]));
    if (fraction < 1) {
      const cv::Size size = labelled_.picture.size();
      const cv::Moments moments = cv::moments(labelled_.matte);
      const cv::Size part(std::max(1, cvRound(size.width * fraction)),
                          std::max(1, cvRound(size.height * fraction)));
      const cv::Point corner(
          std::clamp(cvRound(moments.m10 / moments.m00) - part.width / 2, 0, size.width - part.width),
          std::clamp(cvRound(moments.m01 / moments.m00) - part.height / 2, 0, size.height - part.height));
      const cv::Mat matte = labelled_.matte(cv::Rect(corner, part));
      // A ring of fluid may have nothing in its middle.
      if (cv::countNonZero(matte) > 0) {
        labelled_.matte = matte.clone();
        labelled_.picture = labelled_.picture(cv::Rect(corner, part)).clone();
      }
    }
    piece_scale_ = auto_piece_scale(asked_.pictures[0].picture.size());
    labelled_pieces_ = lay_out(reduce(labelled_.matte, piece_scale_), base_.settings.grid).size();
  }

  double energy(const CandidateIndex& index, const Ground& on) {
    const SubsetIndex in_table(index, on.rows, base_.table.size());
    const LentIndex lent(base_, in_table);
    query::LabelOptions options;
    options.piece_scale = piece_scale_;
    options.costs.vote = 0;
    return label(snapshot_, base_, labelled_.picture, labelled_.matte, options, {}, stop_).assignment.energy;
  }

  std::optional<double> loss_of(const CandidateIndex& index, Ground& on, const SettingResult& measured) {
    const double seconds = 1e-3 * measured.times.all_threads_ms * static_cast<double>(labelled_pieces_);
    if (seconds > options_.label_limit_s) return {};
    if (!on.energy) on.energy = energy(*on.index, on);
    return energy(index, on) / *on.energy - 1;
  }

  // With the first setting that finds nine tenths, else the most thorough.
  void measure_filters(const BuiltIndex& built, const Ground& on, IndexResult& result) {
    std::size_t chosen = 0;
    while (chosen + 1 < built.settings.size() && result.settings[chosen].recall.at_100 < 0.9) ++chosen;
    built.settings[chosen].apply();
    const auto queries = std::span(asked_.queries).first(std::min(kFilteredPieces, asked_.queries.size()));
    for (const Condition& condition : conditions_) {
      say(fmt::format("{}: {}", result.name, condition.name));
      SearchFilter asked{
          .rows = condition.rows ? &*condition.rows : nullptr, .mean_u = {}, .mean_v = {}, .windows = {}};
      if (!condition.windows.empty()) {
        asked.mean_u = base_.table.mean_u;
        asked.mean_v = base_.table.mean_v;
        asked.windows = std::span(condition.windows).first(queries.size());
      }
      const SubsetFilter own(asked, on.rows);
      const auto exact = on.index->search(queries, kBest, own.search_filter());
      FilterResult filtered{condition.name, built.settings[chosen].name, 0, {}, 0, 0};
      for (std::size_t row = 0; row < on.rows.size(); ++row)
        filtered.admitted += own.search_filter().admits(0, row);
      filtered.admitted /= static_cast<double>(on.rows.size());
      if (exact[0].empty()) continue;
      std::vector<std::vector<ScoredPatch>> answers;
      filtered.times = time(*built.index, queries, own.search_filter(), answers);
      filtered.recall =
          recall_of(answers, std::span(exact).first(answers.size()), queries.first(answers.size()), on.space)
              .at_100;
      for (std::size_t i = 0; i < answers.size(); ++i)
        filtered.short_of += answers[i].size() < exact[i].size();
      result.filters.push_back(std::move(filtered));
    }
  }

  const store::Snapshot& snapshot_;
  SearchBase& base_;
  SearchBenchmarkOptions options_;
  const std::function<void(const std::string&)>& progress_;
  std::stop_token stop_;
  BenchmarkPieces asked_;
  std::map<std::size_t, Ground> grounds_;  // by number of rows
  std::vector<Condition> conditions_;
  BenchmarkPicture labelled_;
  std::size_t labelled_pieces_ = 0;
  double piece_scale_ = 1;
};

}  // namespace

Recall recall_of(std::span<const std::vector<ScoredPatch>> found,
                 std::span<const std::vector<ScoredPatch>> exact, std::span<const PieceQuery> queries,
                 const SearchSpace& space) {
  Recall recall{0, 0, 0, 1};
  std::vector<std::uint32_t> scores;
  for (std::size_t i = 0; i < found.size(); ++i) {
    scores.clear();
    std::set<stored::Row> seen;
    for (const ScoredPatch& scored : found[i]) {
      if (scored.row >= space.words.size() || !seen.insert(scored.row).second) continue;
      scores.push_back(static_cast<std::uint32_t>(vision::intersection(
          queries[i].words, space.words[scored.row], space.word_count, &queries[i].mask)));
    }
    const auto fraction = [&](std::size_t k) {
      k = std::min(k, exact[i].size());
      if (k == 0) return 1.0;
      const auto end = scores.begin() + static_cast<std::ptrdiff_t>(std::min(k, scores.size()));
      const auto good = std::count_if(scores.begin(), end,
                                      [&](std::uint32_t score) { return score >= exact[i][k - 1].score; });
      return static_cast<double>(good) / static_cast<double>(k);
    };
    recall.at_1 += fraction(1);
    recall.at_10 += fraction(10);
    recall.at_100 += fraction(kBest);
    recall.worst = std::min(recall.worst, fraction(kBest));
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, found.size()));
  recall.at_1 /= count;
  recall.at_10 /= count;
  recall.at_100 /= count;
  return recall;
}

SearchReport benchmark_search(const store::Snapshot& snapshot, SearchBase& base,
                              std::vector<BenchmarkPicture> pictures, std::span<const MeasuredIndex> indexes,
                              const SearchBenchmarkOptions& options,
                              const std::function<void(const std::string&)>& progress, std::stop_token stop) {
  return Benchmark(snapshot, base, std::move(pictures), options, progress, std::move(stop)).run(indexes);
}

}  // namespace freshet::query
