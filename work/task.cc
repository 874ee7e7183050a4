#include "work/task.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cache/result_cache.h"
#include "freshet/error.h"
#include "platform/text_file.h"

namespace freshet::work {
namespace {

constexpr std::size_t kMaxWords = 1000, kMaxBytes = 100'000;

bool is_ingest(const std::vector<std::string>& words) { return words.front() == "ingest"; }

}  // namespace

SharedCommand::SharedCommand(std::vector<std::string> words) : words_(std::move(words)) {
  const bool known = !words_.empty() && (is_ingest(words_) ||
                                         (words_.size() > 1 && words_[0] == "synth" && words_[1] == "sweep"));
  if (!known)
    throw Error(ErrorKind::kUsage, words_.empty() ? "run" : "run: " + words_.front(),
                "no command that is shared out", "Give ingest or synth sweep, with its arguments");
  std::size_t bytes = 0;
  for (const std::string& word : words_) {
    bytes += word.size();
    for (const std::string_view option :
         {"--shard", "--seal", "--gather", "--threads", "-j", "--config", "--"})
      if (word == option || word.starts_with(std::string(option) + "=") ||
          (option == "-j" && word.starts_with(option)))
        throw Error(ErrorKind::kUsage, "run: " + word, "is not the task's to say",
                    "Leave it out: shards are counted by the task, threads by the worker's own -j");
  }
  if (words_.size() > kMaxWords || bytes > kMaxBytes)
    throw Error(ErrorKind::kUsage, "run",
                fmt::format("has {} words of {} bytes, at most {} of {} expected", words_.size(), bytes,
                            kMaxWords, kMaxBytes),
                "Name a folder of clips instead of each");
}

std::vector<std::string> SharedCommand::shard_words(Shard shard) const {
  std::vector<std::string> words = words_;
  words.insert(words.end(), {"--shard", fmt::format("{}/{}", shard.index, shard.count)});
  if (is_ingest(words_)) words.emplace_back("--seal");
  return words;
}

std::vector<std::string> SharedCommand::gather_words() const {
  std::vector<std::string> words = words_;
  words.emplace_back("--gather");
  return words;
}

std::string Task::text() const {
  return nlohmann::json{{"run", command.words()}, {"shard", {shard.index, shard.count}}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string Task::key() const {
  cache::KeyHash hash;
  hash.add(text());
  return cache::hex(hash.key());
}

Task read_task(const std::string& text) {
  constexpr std::size_t kDeepest = 3;
  const auto refuse = [] {
    throw Error(ErrorKind::kInput, "task", "is none", "Put tasks in by freshet work --submit");
  };
  if (text.size() > 2 * kMaxBytes || json_nesting(text) > kDeepest) refuse();
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("run") || !json.contains("shard")) refuse();
  const nlohmann::json &run = json["run"], &shard = json["shard"];
  const auto is_count = [](const nlohmann::json& number) {
    return number.is_number_unsigned() && number.get<std::uint64_t>() >= 1 &&
           number.get<std::uint64_t>() <= kMaxShards;
  };
  if (!run.is_array() || !std::ranges::all_of(run, [](const auto& word) { return word.is_string(); }) ||
      !shard.is_array() || shard.size() != 2 || !is_count(shard[0]) || !is_count(shard[1]) ||
      shard[0].get<int>() > shard[1].get<int>())
    refuse();
  return {SharedCommand(run.get<std::vector<std::string>>()), {shard[0].get<int>(), shard[1].get<int>()}};
}

}  // namespace freshet::work
