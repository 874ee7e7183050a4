#include "studio/project.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "platform/printable.h"
#include "platform/text_file.h"
#include "studio/clip_strip.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDocument = 16u << 20;
constexpr std::size_t kMaxHistory = 4u << 20, kDeepestHistory = 16;
constexpr const char* kDocument = "document.json";
constexpr const char* kHistory = "history.json";
constexpr const char* kThumbnail = "thumbnail.jpg";
constexpr int kThumbnailSide = 480;  // px

std::string picture_in(const fs::path& folder) {
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, fault))
    if (entry.path().stem() == "picture" && !entry.is_symlink() && entry.is_regular_file())
      return entry.path().filename();
  throw Error(ErrorKind::kInput, folder.string(), "it is no project: there is no picture in it");
}

}  // namespace

std::shared_ptr<Project> Project::create(const fs::path& folder, const fs::path& bytes,
                                         const std::string& ending) {
  if (!media::looks_like_picture("picture" + ending))
    throw Error(ErrorKind::kInput, "a file ending in \"" + ending + "\"",
                "it is no picture that can be opened", "Give a PNG, JPEG, TIFF, WebP or EXR");
  std::error_code fault;
  fs::create_directories(folder.parent_path(), fault);
  if (!fs::create_directory(folder, fault))
    throw Error(ErrorKind::kIo, folder.string(), "the folder cannot be made", "Check its permissions");
  try {
    const fs::path picture = folder / ("picture" + ending);
    fs::rename(bytes, picture, fault);
    if (fault) fs::copy_file(bytes, picture);
    auto project = std::make_shared<Project>(folder);
    project->write(kThumbnail, small_jpeg(project->picture()->bgr, kThumbnailSide));
    project->write(kDocument, to_json({}));
    return project;
  } catch (...) {
    fs::remove_all(folder, fault);
    throw;
  }
}

Project::Project(fs::path folder) : folder_(std::move(folder)) {
  std::error_code fault;
  if (fs::is_symlink(folder_, fault) || !fs::is_directory(folder_, fault))
    throw Error(ErrorKind::kInput, folder_.string(), "it is no project's folder");
  picture_file_ = picture_in(folder_);
  read_document();
}

void Project::read_document() {
  const fs::path path = folder_ / kDocument;
  if (!holds(kDocument)) return;
  try {
    state_.document = document_from_json(read_beneath(folder_, kDocument, kMaxDocument), path.string());
  } catch (const Error& fault) {
    std::error_code ignored;
    fs::rename(path, folder_ / "document.damaged", ignored);
    notice_ = std::string(fault.what()) + " What was drawn is in document.damaged.";
  }
}

Project::State Project::state() const {
  const std::lock_guard lock(guard_);
  return state_;
}

std::optional<std::uint64_t> Project::save(const Document& document, std::uint64_t base) {
  const std::lock_guard lock(guard_);
  if (base != state_.version) return std::nullopt;
  write(kDocument, to_json(document));
  write("strokes.svg", strokes_svg(document, size()));
  write("marks.json", marks_json(document));
  state_.document = document;
  return ++state_.version;
}

std::shared_ptr<const media::Still> Project::picture() const {
  const std::lock_guard lock(picture_guard_);
  if (!picture_) picture_ = std::make_shared<const media::Still>(media::read_still(folder_ / picture_file_));
  return picture_;
}

cv::Size Project::size() const { return picture()->bgr.size(); }

cv::Mat Project::given_matte() const {
  if (!holds("given_matte.png")) return {};
  return media::read_matte(folder_ / "given_matte.png", size()).alpha;
}

void Project::give_matte(const fs::path& bytes) {
  write("given_matte.png", encoded_png(media::read_matte(bytes, size()).alpha));
}

void Project::write_history(std::string_view json) {
  if (json.size() > kMaxHistory || json_nesting(json) > kDeepestHistory || !nlohmann::json::accept(json))
    throw Error(ErrorKind::kInput, "history", "it is no JSON, or too much of it", "Reload the page");
  const std::lock_guard lock(guard_);
  write(kHistory, json);
}

std::string Project::history() const {
  const std::lock_guard lock(guard_);
  return holds(kHistory) ? read_beneath(folder_, kHistory, kMaxHistory) : "null";
}

void Project::write_mattes(const cv::Mat& alpha, const cv::Mat& held) {
  const std::lock_guard lock(guard_);
  whole_ = !alpha.empty() && cv::countNonZero(alpha != 255) == 0;
  write_or_remove("matte.png", whole_ ? cv::Mat() : alpha);
  write_or_remove("hold.png", held);
}

void Project::write_tempo(const cv::Mat& map) {
  const std::lock_guard lock(guard_);
  write_or_remove("tempo.png", map);
}

void Project::write_assignment(const std::string& json) {
  const std::lock_guard lock(guard_);
  std::error_code ignored;
  if (json.empty())
    fs::remove(folder_ / "assignment.json", ignored);
  else
    write("assignment.json", json);
}

void Project::write_recipe(const Document& document) {
  const std::lock_guard lock(guard_);
  write("project.toml", recipe_toml(document, files_of(document)));
}

RecipeFiles Project::recipe_files(const Document& document) const {
  const std::lock_guard lock(guard_);
  return files_of(document);
}

RecipeFiles Project::files_of(const Document& document) const {
  const auto present = [&](const char* name) { return holds(name) ? std::string(name) : std::string(); };
  return {.picture = picture_file_,
          .matte = present("matte.png"),
          .held = present("hold.png"),
          .whole = whole_,
          .strokes = flow_strokes(document, size()).empty() ? "" : present("strokes.svg"),
          .tempo = document.tempo.empty() ? "" : present("tempo.png"),
          .assignment = document.pins.empty() ? "" : present("assignment.json")};
}

void Project::write_way(const std::string& way, const std::vector<WayFile>& files) const {
  for (const WayFile& file : files) write_beneath(folder_, fs::path("ways") / way / file.name, file.bytes);
}

std::shared_ptr<const OpenFile> Project::open_way(const std::string& way, const std::string& name) const {
  return open_beneath(folder_, fs::path("ways") / way / name);
}

std::string Project::read_way(const std::string& way, const std::string& name) const {
  constexpr std::size_t kMost = 32u << 20;
  return read_beneath(folder_, fs::path("ways") / way / name, kMost);
}

void Project::expect_export(const std::string& name) const {
  if (!is_plain_file_name(name))
    throw Error(ErrorKind::kUsage, printable(name), "it is no plain file name",
                "Use letters, digits, dots and dashes");
  const fs::path folder = folder_ / "exports";
  std::error_code fault;
  fs::create_directory(folder, fault);
  if (fs::is_symlink(folder, fault) || !fs::is_directory(folder, fault))
    throw Error(ErrorKind::kIo, folder.string(), "is no folder");
  if (fs::is_symlink(folder / fs::path(name).stem(), fault))
    throw Error(ErrorKind::kUsage, name, "a symbolic link has its name", "Use another");
}

std::shared_ptr<const OpenFile> Project::open_export(const std::string& name) const {
  if (!is_plain_file_name(name)) throw Error(ErrorKind::kNotFound, name, "there is no such export");
  return open_beneath(folder_, fs::path("exports") / name);
}

std::string Project::export_output(const std::string& name) {
  const fs::path file(name);
  if (!media::means_sequence(file)) return "exports/" + name;
  const std::string stem = file.stem();
  return fmt::format("exports/{0}/{0}.####{1}", stem, file.extension().string());
}

void Project::write(const std::string& name, std::string_view bytes) const {
  write_beneath(folder_, name, bytes);
}

void Project::write_or_remove(const char* name, const cv::Mat& map) const {
  std::error_code ignored;
  if (map.empty())
    fs::remove(folder_ / name, ignored);
  else
    write(name, encoded_png(map));
}

bool Project::holds(const std::string& name) const {
  std::error_code fault;
  const fs::file_status status = fs::symlink_status(folder_ / name, fault);
  return fs::is_regular_file(status);
}

std::string thumbnail(const fs::path& folder) {
  constexpr std::size_t kMost = 4u << 20;
  return read_beneath(folder, kThumbnail, kMost);
}

std::string small_jpeg(const cv::Mat& picture, int side) {
  const double scale = std::min(1.0, side / static_cast<double>(std::max(picture.cols, picture.rows)));
  cv::Mat small;
  cv::resize(picture, small,
             {std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale))}, 0, 0,
             cv::INTER_AREA);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", small, bytes);
  return {bytes.begin(), bytes.end()};
}

std::string project_name(const std::string& file) {
  std::string name;
  for (const char c : fs::path(file).stem().string()) {
    const auto letter = static_cast<unsigned char>(c);
    if (letter < 128 && std::isalnum(letter) != 0)
      name += static_cast<char>(std::tolower(letter));
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  name = name.substr(0, 48);
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "picture" : name;
}

bool is_project_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && name.front() != '-' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string_view::npos;
}

bool is_plain_file_name(std::string_view name) {
  return !name.empty() && name.size() <= 128 && name.front() != '.' && name.front() != '-' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") ==
             std::string_view::npos;
}

}  // namespace freshet::studio
