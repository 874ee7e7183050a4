#include "synth/stills/still_set.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/capture_time.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::synth::stills {
namespace {

namespace fs = std::filesystem;

struct Loaded {
  cv::Mat picture;
  std::vector<std::string> notices;
  std::string fault;  // empty: none
  std::optional<std::chrono::sys_seconds> taken;
};

Loaded load(const fs::path& file) {
  Loaded loaded;
  try {
    media::Still still = media::read_still(file);
    loaded.notices = std::move(still.notices);
    loaded.taken = media::capture_time(file);
    if (!still.alpha.empty()) loaded.notices.emplace_back("alpha channel ignored");
    if (still.deep.empty()) {
      loaded.picture = still.bgr;
    } else if (still.deep.depth() == CV_16U) {
      loaded.picture = still.deep;
    } else {
      media::coded_picture(still).convertTo(loaded.picture, CV_16U, 65535);
    }
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::kInput) throw;
    loaded.fault = fault.what();
  }
  return loaded;
}

std::string size_text(cv::Size size) { return fmt::format("{} x {} px", size.width, size.height); }

// What the camera's clock says, for a person: no order is taken from it. Empty where fewer than two stills say
// when they were taken.
std::string time_span(const std::vector<Loaded>& loaded) {
  std::vector<std::chrono::sys_seconds> times;
  for (const Loaded& each : loaded)
    if (each.fault.empty() && each.taken) times.push_back(*each.taken);
  if (times.size() < 2) return {};
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  return fmt::format(
      "by the camera's clock {} stills were taken within {} s, from {:%Y-%m-%d %H:%M:%S} to {:%H:%M:%S}",
      times.size(), (*last - *first).count(), *first, *last);
}

// The files of the folder that may be stills; the rest is told.
std::vector<fs::path> picture_files(const fs::path& folder, std::vector<std::string>& notices) {
  std::error_code fault;
  if (!fs::is_directory(folder, fault))
    throw Error(ErrorKind::kInput, folder.string(), fault ? fault.message() : "it is no folder",
                "Give the folder in which the stills lie");
  const auto seen = [](const fs::path&) { return true; };
  std::vector<fs::path> files, others;
  for (fs::path& file : media::list_folder(folder, seen).files)
    (media::looks_like_picture(file) ? files : others).push_back(std::move(file));
  for (const fs::path& other : others)
    notices.push_back(other.filename().string() + ": no picture by its name, and left out");
  if (files.size() > kMaxStills)
    throw Error(ErrorKind::kInput, folder.string(),
                fmt::format("it holds {} pictures, more than {}", files.size(), kMaxStills),
                "Ten to twenty stills make a scene: take some of them; a dense sequence is a clip for "
                "freshet ingest");
  return files;
}

void refuse_unlike_sizes(const fs::path& folder, const StillSet& set) {
  std::map<std::pair<int, int>, std::vector<std::string>> sizes;
  for (int i = 0; i < set.count(); ++i)
    sizes[{set.pictures[i].cols, set.pictures[i].rows}].push_back(set.names[i]);
  const cv::Size first = set.size();
  if (sizes.size() > 1) {
    const auto commonest = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
      return a.second.size() < b.second.size();
    });
    std::string odd;
    for (const auto& [size, names] : sizes)
      if (size != commonest->first)
        odd += fmt::format("{}{} is {}", odd.empty() ? "" : ", ", names.front(),
                           size_text({size.first, size.second}));
    throw Error(ErrorKind::kInput, folder.string(),
                fmt::format("the stills are of {} sizes: {} of them are {}, but {}", sizes.size(),
                            commonest->second.size(),
                            size_text({commonest->first.first, commonest->first.second}), odd),
                "Move those elsewhere, or develop all alike");
  }
  if (std::min(first.width, first.height) < kMinSide)
    throw Error(ErrorKind::kInput, folder.string(), "the stills are " + size_text(first),
                fmt::format("At least {} px a side are needed", kMinSide));
}

// Two names for one picture would be neighbours without any distance.
void leave_out_twins(StillSet& set) {
  for (int i = 0; i < set.count(); ++i)
    for (int j = i + 1; j < set.count();) {
      if (set.pictures[i].size() != set.pictures[j].size() ||
          set.pictures[i].type() != set.pictures[j].type() ||
          cv::norm(set.pictures[i], set.pictures[j], cv::NORM_INF) != 0) {
        ++j;
        continue;
      }
      set.notices.push_back(
          fmt::format("{}: the same picture as {}, and left out", set.names[j], set.names[i]));
      set.names.erase(set.names.begin() + j);
      set.pictures.erase(set.pictures.begin() + j);
    }
}

}  // namespace

StillSet read_stills(const fs::path& folder, int max_side, const Job& job) {
  StillSet set;
  const std::vector<fs::path> files = picture_files(folder, set.notices);
  std::vector<Loaded> loaded(files.size());
  std::mutex reporting;
  std::size_t done = 0;
  oneapi::tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    if (job.stop.stop_requested()) return;
    loaded[i] = load(files[i]);
    const std::lock_guard lock(reporting);
    if (job.progress) job.progress({"reading stills", ++done, files.size()});
  });
  if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "stills", "stopped");
  bool deep = false;
  std::string fault;
  if (const std::string span = time_span(loaded); !span.empty()) set.notices.push_back(span);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = files[i].filename().string();
    for (const std::string& notice : loaded[i].notices) set.notices.push_back(name + ": " + notice);
    if (!loaded[i].fault.empty()) {
      fault = loaded[i].fault;
      set.notices.push_back(fault + " It is left out");
      continue;
    }
    deep |= loaded[i].picture.depth() == CV_16U;
    set.names.push_back(name);
    set.pictures.push_back(std::move(loaded[i].picture));
  }
  for (cv::Mat& picture : set.pictures)
    if (deep && picture.depth() == CV_8U) picture.convertTo(picture, CV_16U, 257);
  if (set.count() > 0) refuse_unlike_sizes(folder, set);
  const int with_twins = set.count();
  leave_out_twins(set);
  if (set.count() < 2)
    throw Error(ErrorKind::kInput, folder.string(),
                with_twins > set.count()
                    ? fmt::format("its {} stills are one and the same picture", with_twins)
                : set.count() == 1 ? std::string("there is one still in it: nothing moves between one")
                                   : "there is no still in it" + (fault.empty() ? "" : " (" + fault + ")"),
                "Give ten to twenty stills of the scene (PNG, JPEG, TIFF), taken from one place");
  set.file_size = set.size();
  const cv::Size size = max_side > 0 ? reduced_size(set.size(), max_side) : set.size();
  const double across = static_cast<double>(size.width) / set.file_size.width,
               down = static_cast<double>(size.height) / set.file_size.height;
  set.from_file.assign(set.pictures.size(),
                       cv::Matx33d(across, 0, .5 * across - .5, 0, down, .5 * down - .5, 0, 0, 1));
  if (max_side > 0)
    for (cv::Mat& picture : set.pictures) cv::resize(picture.clone(), picture, size, 0, 0, cv::INTER_AREA);
  return set;
}

cv::Size reduced_size(cv::Size size, int max_side) {
  const double scale = std::min(1.0, static_cast<double>(max_side) / std::max(size.width, size.height));
  return {std::max(16, cvRound(size.width * scale)), std::max(16, cvRound(size.height * scale))};
}

std::vector<cv::Mat> reduced(const std::vector<cv::Mat>& pictures, int max_side) {
  std::vector<cv::Mat> out(pictures.size());
  oneapi::tbb::parallel_for(std::size_t{0}, pictures.size(), [&](std::size_t i) {
    const cv::Size size = reduced_size(pictures[i].size(), max_side);
    cv::Mat small;
    cv::resize(pictures[i], small, size, 0, 0, cv::INTER_AREA);
    small.convertTo(out[i], CV_8U, small.depth() == CV_16U ? 1.0 / 257 : 1.0);
  });
  return out;
}

}  // namespace freshet::synth::stills
