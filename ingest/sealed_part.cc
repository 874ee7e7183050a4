#include "ingest/sealed_part.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <regex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "platform/text_file.h"
#include "platform/unfinished_files.h"
#include "platform/whole_file.h"
#include "store/new_file.h"
#include "store/store.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxReport = std::size_t{256} << 20;

fs::path parts_of(const fs::path& store) { return store.string() + ".parts"; }

/// A file beside the one that it is to become, whichever machine and process makes it.
fs::path making_name(const fs::path& file) {
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  return fmt::format("{}.making.{}.{}", file.string(), host, ::getpid());
}

void sync(const fs::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool done = fd >= 0 && ::fsync(fd) == 0;
  const int code = errno;
  if (fd >= 0) ::close(fd);
  if (!done)
    throw Error(ErrorKind::kIo, file.string(), fmt::format("cannot be written ({})", std::strerror(code)),
                "Check the folder and the disk, and run again");
}

void name(const fs::path& making, const fs::path& file) {
  sync(making);
  fs::rename(making, file);
  store::sync_folder_of(file);
}

std::size_t clips_in(const fs::path& file) {
  const std::size_t clips = store::Store::open_read(file).snapshot().clips().size();
  std::error_code ignored;
  fs::remove(file.string() + "-lock", ignored);
  return clips;
}

/// Puts a copy of a store, which is read once more, in its place. Returns the number of its clips.
std::size_t place(const fs::path& made, const fs::path& file) {
  const fs::path making = making_name(file);
  const fs::path lock = making.string() + "-lock";
  const UnfinishedFile listed(making), listed_lock(lock);
  std::error_code ignored;
  try {
    fs::copy_file(made, making, fs::copy_options::overwrite_existing);
    sync(making);
    std::size_t clips = 0;
    {
      const store::Snapshot copy = store::Store::open_read(making).snapshot();
      if (const std::vector<std::string> faults = copy.verify(); !faults.empty())
        throw Error(ErrorKind::kDamaged, file.string(), "was damaged on its way: " + faults.front(),
                    "Check the disk and the network, and run again");
      clips = copy.clips().size();
    }
    fs::remove(lock, ignored);
    name(making, file);
    return clips;
  } catch (...) {
    fs::remove(making, ignored);
    fs::remove(lock, ignored);
    throw;
  }
}

}  // namespace

SealedPart::SealedPart(const fs::path& store, Shard shard) {
  const std::string name = fmt::format("{}-of-{}", shard.index, shard.count);
  store_ = parts_of(store) / (name + ".store");
  report_ = parts_of(store) / (name + ".json");
}

nlohmann::json SealedPart::report() const {
  const std::string remedy = "Remove it, and run the shard again";
  nlohmann::json read = nlohmann::json::parse(read_text_file(report_, kMaxReport, remedy), nullptr, false);
  const auto is_clip = [](const nlohmann::json& clip) {
    return clip.is_object() && clip.contains("name") && clip["name"].is_string() &&
           clip.contains("outcome") && clip["outcome"].is_string() && clip.contains("reasons") &&
           clip["reasons"].is_array() &&
           std::ranges::all_of(clip["reasons"], [](const auto& reason) { return reason.is_string(); });
  };
  if (!read.is_object() || !read["stored"].is_number_unsigned() || !read["clips"].is_array() ||
      !std::ranges::all_of(read["clips"], is_clip))
    throw Error(ErrorKind::kInput, report_.string(), "is garbled", remedy);
  return read;
}

bool SealedPart::is_sealed(const nlohmann::json& made_by) const {
  if (!fs::exists(report_)) return false;
  if (report()["made_by"] == made_by) return true;
  throw Error(ErrorKind::kUsage, report_.string(), "was made by a command with other clips or options",
              "Name another store, or remove the folder " + report_.parent_path().string());
}

void SealedPart::seal(const fs::path& made, const nlohmann::json& made_by, nlohmann::json report) const {
  if (is_sealed(made_by)) return;  // by another machine, meanwhile
  try {
    fs::create_directories(store_.parent_path());
    report["stored"] = fs::exists(made) ? place(made, store_) : 0;
    report["made_by"] = made_by;
    const fs::path making = making_name(report_);
    const UnfinishedFile listed(making);
    write_whole_file(making, report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    name(making, report_);
  } catch (const fs::filesystem_error& fault) {
    throw Error(ErrorKind::kIo, store_.string(),
                fmt::format("cannot be written ({})", fault.code().message()),
                "Check the folder and the disk, and run again");
  }
}

std::vector<SealedPart> sealed_parts(const fs::path& store, const nlohmann::json& made_by) {
  const fs::path folder = parts_of(store);
  static const std::regex kName(R"(([1-9][0-9]{0,8})-of-([1-9][0-9]{0,8})\.json)");
  std::map<int, std::string> of;  // number of shards, and a report
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    std::smatch match;
    const std::string file = entry.path().filename();
    if (std::regex_match(file, match, kName)) of[std::stoi(match[2])] = file;
  }
  if (of.empty())
    throw Error(ErrorKind::kNotFound, folder.string(), "there is no sealed part in it",
                "Run the command with --shard I/N --seal for each");
  if (of.size() > 1)
    throw Error(ErrorKind::kUsage, folder.string(),
                fmt::format("parts of two divisions lie in it, such as {} and {}", of.begin()->second,
                            of.rbegin()->second),
                "Remove those of one");
  const int count = of.begin()->first;
  std::vector<SealedPart> parts;
  std::string missing;
  for (int i = 1; i <= count; ++i) {
    const SealedPart& part = parts.emplace_back(store, Shard{i, count});
    if (!part.is_sealed(made_by)) missing += (missing.empty() ? "" : ", ") + std::to_string(i);
  }
  if (!missing.empty())
    throw Error(ErrorKind::kNotFound, folder.string(),
                fmt::format("shards of {} that are not yet sealed: {}", count, missing),
                "Run the command with --shard I/N --seal for them");
  for (const SealedPart& part : parts) {
    const std::size_t stored = part.report()["stored"].get<std::size_t>();
    if (stored > 0 && (!fs::exists(part.store()) || clips_in(part.store()) != stored))
      throw Error(ErrorKind::kDamaged, part.store().string(),
                  fmt::format("is not the store of {} clips that was sealed", stored),
                  "Remove its report, the .json beside it, and run the shard again");
  }
  return parts;
}

void remove_unsealed(const fs::path& store) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(parts_of(store), ignored)) {
    const std::string file = entry.path().filename();
    if (file.find(".making.") != std::string::npos || file.ends_with("-lock"))
      fs::remove(entry.path(), ignored);
  }
}

}  // namespace freshet::ingest
