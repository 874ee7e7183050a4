// How well is motion guessed where nobody gives a hint, and does labelling gain by it?
//
//   bench_motion_guess STORE [--clips NAME..] [--no-label] [--json FILE]
//
// Each clip of the store is left out in its turn; a still of its middle frame, 640 px long, inside the matte
// of where it moves, is the question, and its mean flow, from the store's motion cells, the answer, at pieces
// where that is at least 2.5 px/s. Guesses: the class's constant (fire and smoke up, water down, clouds
// none), the candidates' votes alone, the classes' pull alone, pull and edges (the default), all three; once
// with the class given and once without. Columns: fraction of moving pieces at which a direction is dared;
// mean angle there, and fractions within 30 and 60 degrees; net, the mean angle over all moving pieces with
// 90 where nothing is dared. Texture's axis alone has no sign: its mean axial angle is given by class (45 is
// chance).
// Then the stills are labelled, class given: without a hint and with the guess; net is the mean angle of the
// motion assigned, coherence the length of its mean direction, beside the truth's. Means over pieces, then
// over clips; also by halves, the odd and the even clips, that a constant fitted to few shows itself.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/harness/machine.h"
#include "freshet/error.h"
#include "media/frame/frame.h"
#include "query/labelling/label_request.h"
#include "query/labelling/labelling.h"
#include "query/labelling/motion_guess.h"
#include "stored/clip_cells.h"
#include "stored/clip_frames.h"

namespace {

using namespace freshet;

constexpr double kLongest = 640;   // px
constexpr double kMinSpeed = 2.5;  // px/s
constexpr double kMinMoving = 0.01;
constexpr double kDegrees = 180 / std::numbers::pi;

struct Question {
  std::string name, class_name;
  cv::Mat still, matte, motion;  // CV_8UC3, CV_8U, CV_32FC2 px/s; all of one size
};

cv::Mat from_cells(const vision::CellMap& cells, cv::Size frame, cv::Size size,
                   const std::function<cv::Vec3f(std::span<const float>)>& value) {
  cv::Mat small(cells.rows, cells.columns, CV_32FC3), full;
  for (int y = 0; y < cells.rows; ++y)
    for (int x = 0; x < cells.columns; ++x) small.at<cv::Vec3f>(y, x) = value(cells.at(y, x));
  cv::resize(small, full, {}, cells.cell, cells.cell, cv::INTER_LINEAR);
  cv::resize(full(cv::Rect({}, frame)), full, size, 0, 0, cv::INTER_AREA);
  return full;
}

std::optional<Question> ask(const store::Snapshot& snapshot, const vision::Settings& settings,
                            store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  Question question{record.name, record.class_name, {}, {}, {}};
  question.still = media::to_bgr(stored::ClipFrames(snapshot, clip).read(record.frame_count / 2));
  const cv::Size frame = question.still.size();
  const double scale = std::min(1.0, kLongest / std::max(frame.width, frame.height));
  const cv::Size size(static_cast<int>(std::lround(frame.width * scale)),
                      static_cast<int>(std::lround(frame.height * scale)));
  cv::resize(question.still, question.still, size, 0, 0, cv::INTER_AREA);
  // Mean motion, and the root of its mean square: what moves.
  const cv::Mat values = from_cells(
      stored::motion_cells(snapshot, settings, clip), frame, size, [](std::span<const float> cell) {
        float square = cell[0] * cell[0] + cell[1] * cell[1];
        for (int b = 0; b < vision::bands_of(static_cast<int>(cell.size())); ++b) {
          const vision::BandPower power = vision::band_power(cell.data(), b);
          square += power.u + power.v;
        }
        return cv::Vec3f(cell[0], cell[1], std::sqrt(square));
      });
  std::vector<cv::Mat> parts;
  cv::split(values, parts);
  question.matte = parts[2] >= settings.min_motion_px * 25;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::morphologyEx(question.matte, question.matte, cv::MORPH_CLOSE, disc);
  cv::morphologyEx(question.matte, question.matte, cv::MORPH_OPEN, disc);
  parts.pop_back();
  cv::merge(parts, question.motion);
  question.motion *= scale;
  if (cv::countNonZero(question.matte) < kMinMoving * static_cast<double>(question.matte.total()))
    return std::nullopt;
  return question;
}

std::vector<cv::Vec2f> true_motion(const Question& question, const query::Target& target) {
  std::vector<cv::Vec2f> motion;
  for (const cv::Point corner : target.corners) {
    const cv::Rect box =
        cv::Rect(corner, cv::Size(target.side, target.side)) & cv::Rect({}, question.still.size());
    const cv::Scalar mean = cv::mean(question.motion(box), question.matte(box));
    motion.emplace_back(static_cast<float>(mean[0]), static_cast<float>(mean[1]));
  }
  return motion;
}

double angle_between(cv::Vec2f a, cv::Vec2f b) {
  const double lengths = cv::norm(a) * cv::norm(b);
  return lengths > 0 ? std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0)) * kDegrees : 90;
}

struct Score {
  double dared = 0, angle = 0, within_30 = 0, within_60 = 0;  // sums over pieces that dare
  double net = 0, u = 0, v = 0, moving = 0;

  void add(cv::Vec2f guess, cv::Vec2f truth) {
    ++moving;
    const double angle_deg = angle_between(guess, truth);
    net += angle_deg;
    if (guess == cv::Vec2f(0, 0)) return;
    ++dared;
    angle += angle_deg;
    within_30 += angle_deg <= 30;
    within_60 += angle_deg <= 60;
    u += guess[0] / cv::norm(guess);
    v += guess[1] / cv::norm(guess);
  }
};

Score score_of(const std::vector<cv::Vec2f>& guess, const std::vector<cv::Vec2f>& truth) {
  Score score;
  for (std::size_t piece = 0; piece < truth.size(); ++piece)
    if (cv::norm(truth[piece]) >= kMinSpeed) score.add(guess[piece], truth[piece]);
  return score;
}

// Over clips, each counting once.
struct Mean {
  double clips = 0, dared = 0, angle = 0, within_30 = 0, within_60 = 0, net = 0, coherence = 0;

  void add(const Score& score) {
    ++clips;
    dared += score.dared / score.moving;
    angle += score.angle / score.moving;
    within_30 += score.within_30 / score.moving;
    within_60 += score.within_60 / score.moving;
    net += score.net / score.moving;
    coherence += std::hypot(score.u, score.v) / score.moving;
  }
  nlohmann::json json() const {
    const auto of_dared = [&](double sum) {
      return dared > 0 ? nlohmann::json(sum / dared) : nlohmann::json();
    };
    return {{"clips", clips},
            {"dared", dared / clips},
            {"angle_deg", of_dared(angle)},
            {"within_30", of_dared(within_30)},
            {"within_60", of_dared(within_60)},
            {"net_deg", net / clips},
            {"coherence", coherence / clips}};
  }
  std::string row(const std::string& method, const std::string& group) const {
    const auto of_dared = [&](const char* form, double sum) {
      return dared > 0 ? fmt::format(fmt::runtime(form), sum / dared) : std::string("-");
    };
    return fmt::format("| {} | {} | {:.2f} | {} | {} | {} | {:.1f} | {:.2f} |", method, group, dared / clips,
                       of_dared("{:.1f}", angle), of_dared("{:.2f}", within_30),
                       of_dared("{:.2f}", within_60), net / clips, coherence / clips);
  }
};

struct Table {
  std::vector<std::string> methods;
  std::map<std::string, std::map<std::string, Mean>> means;  // by method and group

  void add(const std::string& method, const std::string& class_name, std::size_t number, const Score& score) {
    if (score.moving == 0) return;
    if (!means.contains(method)) methods.push_back(method);
    for (const std::string& group :
         {class_name, std::string("all"), std::string(number % 2 == 0 ? "even half" : "odd half")})
      means[method][group].add(score);
  }
};

std::vector<cv::Vec2f> directions(const query::MotionGuess& guess) {
  std::vector<cv::Vec2f> found;
  for (const query::PieceGuess& piece : guess.pieces) found.push_back(piece.direction);
  return found;
}

std::vector<cv::Vec2f> assigned(const query::Labelling& labelling) {
  std::vector<cv::Vec2f> motion;
  const query::CandidateSearch& search = labelling.search;
  for (std::size_t piece = 0; piece < search.target.size(); ++piece) {
    const stored::Row row = search.candidates.rows_of(piece)[labelling.labels[piece]];
    motion.emplace_back(search.table().mean_u[row], search.table().mean_v[row]);
  }
  return motion;
}

cv::Vec2f constant_of(const std::string& class_name) {
  if (class_name == "fire" || class_name == "smoke") return {0, -1};
  return class_name == "water" ? cv::Vec2f(0, 1) : cv::Vec2f(0, 0);
}

struct Method {
  std::string name;
  query::GuessOptions options;
};

std::vector<Method> methods() {
  std::vector<Method> all;
  const auto add = [&](const char* name, double gravity, double edges, double votes) {
    query::GuessOptions options;
    options.gravity = gravity;
    options.edges = edges;
    options.votes = votes;
    all.push_back({name, options});
  };
  add("votes alone", 0, 0, 1);
  add("pull alone", 1, 0, 0);
  add("pull and edges", 1, query::GuessOptions{}.edges, 0);
  add("pull, edges and votes", 1, query::GuessOptions{}.edges, 1);
  return all;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("How well is motion guessed where nobody gives a hint?");
  std::string store_path, json_path;
  std::vector<std::string> clips;
  bool no_label = false;
  app.add_option("STORE", store_path)->required();
  app.add_option("--clips", clips, "Only these, by name or a part of it");
  app.add_flag("--no-label", no_label, "Do not label");
  app.add_option("--json", json_path);
  CLI11_PARSE(app, argc, argv);

  const store::Snapshot snapshot = store::Store::open_read(store_path).snapshot();
  const query::SearchBase base = query::open_search(snapshot);
  fmt::print("{}\n{} patches\n\n", bench::to_string(bench::this_machine()), base.table.size());
  Table table;
  std::map<std::string, std::pair<double, double>> axial;  // sum of means and clips, by class
  std::size_t number = 0;
  double seconds = 0;
  for (const store::ClipId clip : snapshot.clips()) {
    const std::string name = snapshot.clip(clip).name;
    if (!clips.empty() && std::none_of(clips.begin(), clips.end(), [&](const std::string& part) {
          return name.find(part) != std::string::npos;
        }))
      continue;
    const std::optional<Question> question = ask(snapshot, base.settings, clip);
    if (!question) continue;
    query::LabelOptions options;
    options.candidates.excluded_clips = {name};
    std::vector<cv::Vec2f> truth;
    query::MotionGuide guide;
    for (const bool given : {false, true}) {
      options.candidates.class_name = given ? question->class_name : "";
      const query::CandidateSearch search =
          query::search_candidates(snapshot, base, question->still, question->matte, options);
      truth = true_motion(*question, search.target);
      const std::string suffix = given ? ", class given" : ", no class";
      if (given)
        table.add("constant of the class", question->class_name, number,
                  score_of(std::vector(truth.size(), constant_of(question->class_name)), truth));
      for (const Method& method : methods()) {
        const double before = bench::process_seconds();
        const query::MotionGuess guess =
            query::guess_motion(snapshot, search, question->still, question->matte, method.options);
        seconds += bench::process_seconds() - before;
        table.add(method.name + suffix, question->class_name, number, score_of(directions(guess), truth));
        if (method.name == "pull and edges") {
          guide = guess.guide;
          fmt::print("{}{}: {}\n", name, suffix, guess.report);
        }
      }
      if (!given) continue;
      // Edges alone, sharpened till the axis is what is left: without sign, so from a pull that is tiny.
      query::GuessOptions edges;
      edges.gravity = 1e-3;
      edges.min_certainty = 0;
      edges.edges = 100;
      const auto axis =
          directions(query::guess_motion(snapshot, search, question->still, question->matte, edges));
      double sum = 0, moving = 0;
      for (std::size_t piece = 0; piece < truth.size(); ++piece) {
        if (cv::norm(truth[piece]) < kMinSpeed) continue;
        const double angle = angle_between(axis[piece], truth[piece]);
        sum += std::min(angle, 180 - angle);
        ++moving;
      }
      if (moving > 0) {
        axial[question->class_name].first += sum / moving;
        axial[question->class_name].second += 1;
      }
    }
    if (!no_label) {
      table.add("truth", question->class_name, number, score_of(truth, truth));
      const query::Labelling plain = query::label(snapshot, base, question->still, question->matte, options);
      const Score without = score_of(assigned(plain), truth);
      table.add("labelled, no hint", question->class_name, number, without);
      if (!guide.empty()) query::adopt_guess(guide, options);
      const query::Labelling hinted =
          guide.empty() ? plain : query::label(snapshot, base, question->still, question->matte, options);
      const Score with = score_of(assigned(hinted), truth);
      table.add("labelled, guess", question->class_name, number, with);
      fmt::print("{}: labelled {:.0f} degrees without, {:.0f} with the guess\n", name,
                 without.net / without.moving, with.net / with.moving);
    }
    std::fflush(stdout);
    ++number;
  }
  fmt::print(
      "\n| method | clips | dared | angle | within 30 | within 60 | net | coherence |\n"
      "| --- | --- | --: | --: | --: | --: | --: | --: |\n");
  nlohmann::json json{{"machine", bench::to_json(bench::this_machine())}};
  for (const std::string& method : table.methods)
    for (const auto& [group, mean] : table.means[method]) {
      fmt::print("{}\n", mean.row(method, group));
      json["methods"][method][group] = mean.json();
    }
  fmt::print("\nTexture's axis alone, mean axial angle (chance 45):");
  for (const auto& [name, sum] : axial) {
    fmt::print(" {} {:.1f}", name, sum.first / sum.second);
    json["axis_deg"][name] = sum.first / sum.second;
  }
  fmt::print("\n{:.3f} s of CPU a guess\n",
             seconds / static_cast<double>(2 * methods().size() * std::max<std::size_t>(number, 1)));
  if (!json_path.empty()) std::ofstream(json_path) << json.dump(2) << '\n';
} catch (const freshet::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
