#include "ingest/ingest.h"

#include "freshet/ingest.h"
#include "ingest/growing_store.h"
#include "library/opencv_threads.h"
#include "query/index/index_builder.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet {
namespace {

IngestOutcome outcome_of(ingest::Outcome outcome) {
  switch (outcome) {
    case ingest::Outcome::kAdded:
      return IngestOutcome::kAdded;
    case ingest::Outcome::kAlreadyThere:
      return IngestOutcome::kAlreadyThere;
    case ingest::Outcome::kRefused:
      return IngestOutcome::kRefused;
    case ingest::Outcome::kWouldAdd:  // by a preview alone
    case ingest::Outcome::kFailed:
      break;
  }
  return IngestOutcome::kFailed;
}

}  // namespace

IngestReport add_clips(const std::filesystem::path& path, std::span<const std::filesystem::path> paths,
                       const IngestOptions& options, const Job& job) {
  const OneOpenCvThread one;
  ingest::GrowingStore growing(path, paths, {}, [] { return vision::Settings{}; });
  const ingest::IngestReport found = ingest::ingest(
      growing.store(), growing.settings(), paths,
      {.class_name = options.class_name, .licence = options.licence, .force = options.force},
      [&](const ingest::IngestProgress& at) {
        if (job.progress && at.source != nullptr)
          job.progress({at.source->name, at.frames, at.claimed_frames});
      },
      job.stop);
  IngestReport report{.clips = {}, .stopped = found.stopped};
  for (const ingest::ClipReport& clip : found.clips)
    report.clips.push_back({.name = clip.name,
                            .outcome = outcome_of(clip.outcome),
                            .reasons = clip.reasons,
                            .frames = clip.frames,
                            .patches = clip.patches});
  if (!growing.remove_if_empty() && !report.stopped)
    query::build_index(growing.store(), {}, job.progress, job.stop);
  return report;
}

}  // namespace freshet
