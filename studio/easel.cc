#include "studio/easel.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "query/labelling/assignment.h"
#include "query/search/picture_scale.h"
#include "studio/drawing/drawn_matte.h"
#include "studio/drawing/fields.h"
#include "studio/drawing/outlines.h"
#include "studio/drawing/reduced.h"
#include "studio/jobs/event_feed.h"
#include "synth/matte/held.h"
#include "vision/look/bars.h"
#include "vision/look/lies_at.h"
#include "vision/look/standing.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr int kSmallSide = 320;          // px: a first preview's longer side
constexpr int kSmallFrames = 48;         // at most
constexpr int kFullSide = 1280;          // px: a full preview's longer side, at most
constexpr int kFieldSide = 64;           // cells of the field that a page draws, along its longer side
constexpr int kLayersAhead = 12;         // live frames that are made at once
constexpr double kLayersPerSecond = 40;  // and of the others
constexpr double kLeastStanding = 1e-4;  // of the picture: smaller things are not offered to be held
constexpr double kLeastLying = 2e-5;     // nor taken by a click
constexpr int kLargestSide = 1 << 20;    // px
constexpr double kLeastSize = .01, kLargestSize = 50;  // times what a plain click takes, which is up to all

std::string text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The matte that an animation is given.
cv::Mat fluid_of(const FoundMatte& matte) {
  return matte.held.empty() ? matte.alpha
                            : synth::matte::less_held(matte.alpha, matte.held, "what is held still");
}

ReelScene scene_of(const media::Still& still, const FoundMatte& matte, const Document& document,
                   double factor) {
  return {.picture = reduced(still.bgr, factor),
          .matte = reduced(fluid_of(matte), factor),
          .held = reduced(matte.held, factor),
          .tempo = reduced(draw_tempo(document, still.bgr.size()), factor),
          .factor = factor};
}

Json matte_json(const FoundMatte& matte) {
  return {{"number", matte.number},
          {"share", cv::mean(matte.alpha)[0] / 255},
          {"held", !matte.held.empty()},
          {"notices", matte.notices}};
}

Json reel_json(const FrameReel& reel) {
  return {{"number", reel.number},      {"stage", reel.stage}, {"width", reel.size.width},
          {"height", reel.size.height}, {"fps", reel.fps},     {"total", reel.total},
          {"ready", reel.ready()},      {"first", reel.first}};
}

/// Whether the frame that was added last is news.
bool is_told(const FrameReel& reel) {
  const int ready = reel.ready();
  return ready < 4 || ready == reel.total || ready % 4 == 0;
}

/// Velocities of a motion, px/s, as rows of u and v in tenths.
std::string field_text(const cv::Mat& motion, cv::Size picture, const char* source) {
  Json json{{"columns", motion.cols},   {"rows", motion.rows}, {"width", picture.width},
            {"height", picture.height}, {"source", source},    {"u", Json::array()},
            {"v", Json::array()}};
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const cv::Vec2f at = motion.at<cv::Vec2f>(y, x);
      json["u"].push_back(std::round(at[0] * 10) / 10);
      json["v"].push_back(std::round(at[1] * 10) / 10);
    }
  return text(json);
}

cv::Size coarse(cv::Size picture) {
  const double factor = reduction(picture, kFieldSide);
  return {std::max(1, cvRound(picture.width / factor)), std::max(1, cvRound(picture.height / factor))};
}

/// The field that strokes ask, by a small copy: the full one takes a tenth of a second and more.
cv::Mat asked_motion(const Document& document, cv::Size picture) {
  constexpr int kSide = 256;     // px
  constexpr float kUnsaid = 60;  // px/s that are shown where nobody says how fast
  const double factor = reduction(picture, kSide);
  const cv::Size size(std::max(1, cvRound(picture.width / factor)),
                      std::max(1, cvRound(picture.height / factor)));
  const query::MotionGuide guide = request_of(reduced(document, factor), size).options.guide;
  cv::Mat motion(size, CV_32FC2, cv::Scalar(0, 0));
  for (int y = 0; y < size.height && !guide.direction.empty(); ++y)
    for (int x = 0; x < size.width; ++x) {
      const float asked = guide.speed.empty() ? -1 : guide.speed.at<float>(y, x);
      const float speed = asked < 0 ? kUnsaid : asked * static_cast<float>(factor);
      motion.at<cv::Vec2f>(y, x) = guide.direction.at<cv::Vec2f>(y, x) * speed;
    }
  cv::resize(motion, motion, coarse(picture), 0, 0, cv::INTER_AREA);
  return motion;
}

void stop_if_asked(const Job& job) {
  if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "preview", "stopped");
}

}  // namespace

Easel::Easel(std::shared_ptr<Project> project, Tell tell)
    : project_(std::move(project)), tell_(std::move(tell)) {}

Easel::Results Easel::results() const {
  const std::lock_guard lock(guard_);
  return results_;
}

std::shared_ptr<const FoundMatte> Easel::matte() const { return results().matte; }
std::shared_ptr<const LabelledPicture> Easel::labelled() const { return results().labelled; }
bool Easel::is_labelled(const Document& document) const {
  return results().labels_key == labels_key(document);
}
std::string Easel::field_json() const { return results().field; }

std::shared_ptr<const FrameReel> Easel::reel(std::uint64_t number) const {
  const Results now = results();
  if (now.small && now.small->number == number) return now.small;
  if (now.full && now.full->number == number) return now.full;
  if (now.layers && now.layers->number == number) return now.layers;
  return nullptr;
}

void Easel::bring_up_to_date(OpenedStore* store, cache::ResultCache* cache, const Job& job) {
  const Document document = project_->state().document;
  tell_problem("");
  try {
    work(document, store, cache, job);
  } catch (const Error& fault) {
    if (fault.kind() == ErrorKind::kCancelled) throw;
    tell_problem(fault.what());
  }
  tell_settled(document);
}

void Easel::tell_settled(const Document& document) {
  const Results now = results();
  const bool stands = now.full && now.frames_key == frames_key(document);
  tell_("settled", text({{"project", project_->id()}, {"reel", stands ? reel_json(*now.full) : Json()}}));
}

void Easel::work(const Document& document, OpenedStore* store, cache::ResultCache* cache, const Job& job) {
  const std::shared_ptr<const FoundMatte> matte = find_matte(document, job);
  stop_if_asked(job);
  const bool is_said = !flow_strokes(document, project_->size()).empty();
  if (is_said || document.store.empty() || store == nullptr) tell_field(document);
  stop_if_asked(job);
  if (!document.tempo.empty()) project_->write_tempo(draw_tempo(document, project_->size()));
  project_->write_recipe(document);
  if (!matte || matte->alpha.empty() || store == nullptr || !store->exists()) return;
  if (results().frames_key == frames_key(document)) return;
  const std::shared_ptr<const StoreBase> base = store->base(job.progress);
  render_small(document, *matte, base, job);
  const std::shared_ptr<const LabelledPicture> labelled = find_labels(document, *matte, base, cache, job);
  render_full(document, *matte, *labelled, job);
  const std::lock_guard lock(guard_);
  results_.frames_key = frames_key(document);
}

std::shared_ptr<const FoundMatte> Easel::find_matte(const Document& document, const Job& job) {
  const std::shared_ptr<const FoundMatte> before = results().matte;
  if (before && before->key == matte_key(document)) return before;
  const std::shared_ptr<const media::Still> still = project_->picture();
  const cv::Mat given = document.matte_base == MatteBase::kFile    ? project_->given_matte()
                        : document.matte_base == MatteBase::kWhole ? vision::matte_within_bars(still->bgr)
                                                                   : cv::Mat();
  const bool slow = document.matte_base == MatteBase::kScribbles && !document.scribbles.empty();
  if (slow && job.progress) job.progress({"finding the matte", 0, 0});
  for (const Care care : {Care::kDraft, Care::kFull}) {
    if (care == Care::kDraft && !slow) continue;
    stop_if_asked(job);
    std::optional<DrawnMatte> drawn = draw_matte(document, still->bgr, still->alpha, given, care, job.stop);
    stop_if_asked(job);
    keep_matte(document, drawn ? std::move(*drawn) : DrawnMatte(), care);
  }
  return results().matte;
}

void Easel::keep_matte(const Document& document, DrawnMatte drawn, Care care) {
  auto found = std::make_shared<FoundMatte>();
  found->key = care == Care::kFull ? matte_key(document) : 0;
  found->number = next_number();
  found->alpha = std::move(drawn.alpha);
  found->held = draw_held(document, project_->size());
  found->notices = std::move(drawn.notices);
  if (care == Care::kFull) project_->write_mattes(found->alpha, found->held);
  {
    const std::lock_guard lock(guard_);
    results_.matte = found;
    results_.frames_key = 0;
  }
  tell_("matte",
        text({{"project", project_->id()}, {"matte", found->alpha.empty() ? Json() : matte_json(*found)}}));
}

void Easel::tell_field(const Document& document) {
  const cv::Size size = project_->size();
  const std::string field = flow_strokes(document, size).empty()
                                ? "null"
                                : field_text(asked_motion(document, size), size, "strokes");
  {
    const std::lock_guard lock(guard_);
    if (results_.field == field) return;
    results_.field = field;
  }
  tell_("field", text({{"project", project_->id()}}));
}

void Easel::render_small(const Document& document, const FoundMatte& matte,
                         const std::shared_ptr<const StoreBase>& base, const Job& job) {
  const std::shared_ptr<const media::Still> still = project_->picture();
  const double factor = reduction(still->bgr.size(), kSmallSide);
  ReelScene scene = scene_of(*still, matte, document, factor);
  scene.factor = 1;  // it is labelled small
  scene.motion_alone = true;
  if (cv::countNonZero(scene.matte) == 0) return;
  const LabelledPicture labelled =
      label_picture(base, scene.picture, scene.matte, reduced(matte.alpha, factor), reduced(document, factor),
                    nullptr, job);
  stop_if_asked(job);
  const int frames = std::min(document.frames, kSmallFrames);
  const auto reel =
      std::make_shared<FrameReel>(next_number(), "small", scene.picture.size(), frames, document.fps);
  roll(reel, [&](const std::function<void()>& told) { render(labelled, document, scene, *reel, told, job); });
}

std::shared_ptr<const LabelledPicture> Easel::find_labels(const Document& document, const FoundMatte& matte,
                                                          const std::shared_ptr<const StoreBase>& base,
                                                          cache::ResultCache* cache, const Job& job) {
  {
    const Results now = results();
    if (now.labelled && now.labels_key == labels_key(document) && now.labelled->store == base)
      return now.labelled;
  }
  const std::shared_ptr<const media::Still> still = project_->picture();
  auto labelled = std::make_shared<const LabelledPicture>(
      label_picture(base, still->bgr, fluid_of(matte), matte.alpha, document, cache, job));
  project_->write_assignment(query::to_json(labelled->labelling.assignment));
  project_->write_recipe(document);
  std::string field;
  if (flow_strokes(document, still->bgr.size()).empty()) {
    cv::Mat motion = assigned_motion(*labelled, still->bgr.size());
    cv::resize(motion, motion, coarse(still->bgr.size()), 0, 0, cv::INTER_AREA);
    field = field_text(motion, still->bgr.size(), "patches");
  }
  {
    const std::lock_guard lock(guard_);
    results_.labelled = labelled;
    results_.labels_key = labels_key(document);
    if (!field.empty()) results_.field = field;
  }
  if (!field.empty()) tell_("field", text({{"project", project_->id()}}));
  tell_("labels", text({{"project", project_->id()}, {"number", next_number()}}));
  return labelled;
}

ReelScene Easel::full_scene(const Document& document, const FoundMatte& matte,
                            const LabelledPicture& labelled) const {
  const std::shared_ptr<const media::Still> still = project_->picture();
  // Never below the size at which it was cut into pieces.
  const double factor =
      std::min(reduction(still->bgr.size(), kFullSide), labelled.labelling.assignment.piece_scale);
  return scene_of(*still, matte, document, factor);
}

void Easel::render_full(const Document& document, const FoundMatte& matte, const LabelledPicture& labelled,
                        const Job& job) {
  const ReelScene scene = full_scene(document, matte, labelled);
  const auto reel =
      std::make_shared<FrameReel>(next_number(), "full", scene.picture.size(), document.frames, document.fps);
  roll(reel, [&](const std::function<void()>& told) { render(labelled, document, scene, *reel, told, job); });
}

void Easel::find_takes(const Job& job) {
  const Document document = project_->state().document;
  const Results now = results();
  if (!now.matte || !now.labelled || now.frames_key != frames_key(document))
    throw Error(ErrorKind::kNotFound, project_->id(), "its animation is not there", "Wait for the preview");
  const ReelScene scene = full_scene(document, *now.matte, *now.labelled);
  auto takes = std::make_shared<const FoundTakes>(studio::find_takes(*now.labelled, document, scene, job));
  {
    const std::lock_guard lock(guard_);
    results_.takes = takes;
  }
  tell_("takes", text({{"project", project_->id()}, {"number", takes->number}}));
}

std::shared_ptr<const FoundTakes> Easel::takes() const { return results().takes; }

void Easel::show_layers(int first, const Job& job) {
  const Document document = project_->state().document;
  const auto tell = [&](const FrameReel* reel, const std::string& problem) {
    tell_("layers", text({{"project", project_->id()},
                          {"reel", reel != nullptr ? reel_json(*reel) : Json()},
                          {"problem", problem}}));
  };
  std::shared_ptr<FrameReel> reel;
  std::chrono::steady_clock::time_point begun;
  const LiveLayers::Places places{
      .project = project_->folder(),
      .write = [&](const auto& folder, const auto& files) { project_->write_way(folder, files); },
      .begin =
          [&](cv::Size size, int frames, double fps, int from) {
            reel = std::make_shared<FrameReel>(next_number(), "layers", size, frames, fps, from);
            begun = std::chrono::steady_clock::now();
            const std::lock_guard lock(guard_);
            results_.layers = reel;
          },
      .add =
          [&](const cv::Mat& frame) {
            reel->add(frame);
            if (is_told(*reel)) tell(reel.get(), "");
            // Faster than it is played is of no use: the page draws on the same processor.
            const double due_s = (reel->ready() - kLayersAhead) / kLayersPerSecond;
            std::this_thread::sleep_until(begun + std::chrono::duration_cast<std::chrono::milliseconds>(
                                                      std::chrono::duration<double>(due_s)));
          }};
  try {
    expect_no_links(project_->folder());
    live_layers_.render(document, project_->picture()->bgr, first, places, job);
  } catch (const Error& fault) {
    if (fault.kind() == ErrorKind::kCancelled) throw;
    tell(nullptr, fault.what());
  }
}

void Easel::roll(const std::shared_ptr<FrameReel>& reel,
                 const std::function<void(const std::function<void()>&)>& frames) {
  {
    const std::lock_guard lock(guard_);
    const bool small = reel->stage == "small";
    (small ? results_.small : results_.full) = reel;
    if (!small) results_.frames_key = 0;  // a finished one has made room for one that is begun
  }
  const auto tell = [&] { tell_("reel", text({{"project", project_->id()}, {"reel", reel_json(*reel)}})); };
  frames([&] {
    if (is_told(*reel)) tell();
  });
}

void Easel::tell_problem(const std::string& problem) {
  {
    const std::lock_guard lock(guard_);
    if (results_.problem == problem) return;
    results_.problem = problem;
  }
  tell_("problem", text({{"project", project_->id()}, {"text", problem}}));
}

std::string Easel::overview_json() const {
  const Results now = results();
  Json json{{"matte", nullptr},       {"small", nullptr},
            {"full", nullptr},        {"labels", now.labelled != nullptr},
            {"problem", now.problem}, {"field", now.field != "null"}};
  if (now.matte && !now.matte->alpha.empty()) json["matte"] = matte_json(*now.matte);
  if (now.small) json["small"] = reel_json(*now.small);
  if (now.full) json["full"] = reel_json(*now.full);
  return text(json);
}

std::string Easel::picture_jpeg(const cv::Rect& part, int longest) const {
  const std::shared_ptr<const media::Still> still = project_->picture();
  const cv::Rect whole({}, still->bgr.size()), seen = part.empty() ? whole : part & whole;
  if (seen.empty()) throw Error(ErrorKind::kNotFound, "picture", "there is nothing of it there");
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", reduced(still->bgr(seen), reduction(seen.size(), longest)), bytes,
               {cv::IMWRITE_JPEG_QUALITY, 92});
  return {bytes.begin(), bytes.end()};
}

std::string Easel::standing_json() const {
  const Results now = results();
  if (!now.matte || now.matte->alpha.empty())
    throw Error(ErrorKind::kNotFound, project_->id(), "it has no matte yet", "Scribble on what flows");
  const std::shared_ptr<const media::Still> still = project_->picture();
  // Outlines at most this large are as fine as the guess.
  const double factor = reduction(still->bgr.size(), kFullSide);
  cv::Mat stands = vision::what_stands(reduced(still->bgr, factor), reduced(now.matte->alpha, factor)) > 127;
  if (!now.matte->held.empty()) stands.setTo(0, reduced(now.matte->held, factor) > 127);
  return outlines_json(outlines_of(stands, kLeastStanding * stands.total()), factor).dump();
}

std::string Easel::lying_json(const Json& asked) const {
  std::size_t points = 0;
  const Fields fields(asked, "request", points);
  fields.only({"x", "y", "size", "held"});
  const cv::Point at(fields.integer("x", 0, kLargestSide), fields.integer("y", 0, kLargestSide));
  const double size = fields.number("size", kLeastSize, kLargestSize);
  const std::vector<Drawn> marks = fields.drawn("held");
  const Results now = results();
  if (!now.matte || now.matte->alpha.empty())
    throw Error(ErrorKind::kNotFound, project_->id(), "it has no matte yet", "Scribble on what flows");
  const std::shared_ptr<const media::Still> still = project_->picture();
  if (!cv::Rect({}, still->bgr.size()).contains(at))
    throw Error(ErrorKind::kNotFound, "picture", "there is nothing of it there");
  cv::Mat held = cv::Mat::zeros(still->bgr.size(), CV_8U);
  paint(marks, held);
  const bool holds = held.at<std::uint8_t>(at) <= 127;
  const double factor = reduction(still->bgr.size(), kFullSide);
  const cv::Mat small = reduced(still->bgr, factor);
  const auto there = [&](const cv::Point2f& point) {
    return cv::Point(std::clamp(static_cast<int>(point.x / factor), 0, small.cols - 1),
                     std::clamp(static_cast<int>(point.y / factor), 0, small.rows - 1));
  };
  std::vector<cv::Point> others;
  cv::Mat alone(small.size(), CV_8U);
  for (const Drawn& mark : marks) {
    if (mark.adds == holds) continue;
    if (!mark.is_area) {
      others.push_back(there(mark.points[mark.points.size() / 2]));
      continue;
    }
    std::vector<cv::Point> outline;
    for (const cv::Point2f& point : mark.points) outline.push_back(there(point));
    const cv::Rect box = cv::boundingRect(outline);
    alone(box).setTo(0);
    cv::fillPoly(alone, outline, 255);
    others.push_back(vision::innermost(alone(box)) + box.tl());
  }
  const cv::Mat lies = vision::what_lies_at(small, reduced(now.matte->alpha, factor), reduced(held, factor),
                                            there(at), others, size * vision::kClickTakes);
  return Json{{"holds", holds},
              {"outlines", outlines_json(outlines_of(lies, kLeastLying * lies.total()), factor)}}
      .dump();
}

std::string Easel::matte_png(const cv::Mat& alpha, int longest) const {
  const cv::Mat small = reduced(alpha, reduction(alpha.size(), longest));
  const cv::Mat white(small.size(), CV_8U, cv::Scalar(255));
  cv::Mat scene;
  cv::merge(std::vector<cv::Mat>{white, white, white, small}, scene);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", scene, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  return {bytes.begin(), bytes.end()};
}

}  // namespace freshet::studio
