// studio/ways.h — what commands make of a project: its export, films of the ways of ways/way.h, and what they are
// given.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "studio/beneath.h"
#include "studio/jobs/jobs.h"
#include "studio/projects.h"
#include "studio/stores.h"
#include "studio/studio_folder.h"
#include "studio/ways/way.h"
#include "work/command_run.h"

namespace freshet::studio {

/// Texts are JSON. Safe from many threads. Errors as Projects.
class Ways {
 public:
  /// program   the executable that is run. All must outlive this.
  Ways(StudioFolder& folder, Jobs& jobs, Stores& stores, Projects& projects, std::filesystem::path program);
  Ways(const Ways&) = delete;
  Ways& operator=(const Ways&) = delete;

  /// Its commands, run as one job. Told as "way" when its film is there.
  JobId run(const std::string& project, const std::string& way);
  /// The way's film, made again by the same commands, as a file in exports/ or, with the ending of a picture, a folder
  /// of them. alone   its fluid with alpha, or its layers, instead. Returns its "job", "folder" and "command". Throws
  /// Error{kUsage} for a way whose film is MP4 alone, or that has nothing alone.
  std::string export_film(const std::string& project, const std::string& way, const std::string& name,
                          bool alone);
  /// Its "film", a number that another film does not have, or null; its "commands"; what the last one "found", and
  /// "made", a number as the film's, or null; the names of what is "shown"; what it "lacks", in words, before it can be
  /// run; and what can be exported "alone", "fluid", "layers" or "".
  std::string to_json(const std::string& project, const std::string& way);
  /// Throws Error{kNotFound} before it is made.
  std::shared_ptr<const OpenFile> film(const std::string& project, const std::string& way);
  /// A file that the way shows (WayPlan::shown). Throws Error{kNotFound}.
  std::shared_ptr<const OpenFile> file(const std::string& project, const std::string& way,
                                       const std::string& name);

  /// name   of the file in exports/, or with the ending of a picture of a folder of them. options   further words for
  /// `synth animate`: "--layer=fluid".
  JobId export_animation(const std::string& project, const std::string& name,
                         const std::vector<std::string>& options);
  std::string exports_json(const std::string& project);
  /// The command line that makes the same.
  static work::Command export_command(const std::string& program, const Project& project,
                                      const std::string& name, const std::vector<std::string>& options);

  /// PNG, white, with the matte that a layer's scribbles mean as its alpha, for the eye: a draft. Throws
  /// Error{kNotFound}.
  std::string layer_matte_png(const std::string& project, std::uint64_t layer);

  /// The stills of the project's scene (still_folder.h).
  std::string stills_json(const std::string& project);
  std::string still_jpeg(const std::string& project, const std::string& name);
  std::string still_thumbnail(const std::string& project, const std::string& name);
  /// file   moved.
  void add_still(const std::string& project, const std::filesystem::path& file, const std::string& name);
  /// And what was made of them.
  void remove_stills(const std::string& project);

  /// A clip for the project alone (clip_folder.h). file   moved. Returns its name there.
  std::string add_clip(const std::string& project, const std::filesystem::path& file,
                       const std::string& name);
  std::string clips_json(const std::string& project);
  /// The first frame, as it is, JPEG. own   the project's, else its store's. Throws Error{kNotFound}, Error{kInput}.
  std::string clip_frame(const std::string& project, const std::string& clip, bool own);
  /// A project of the clip's first frame, begun with it; or the one that there is already. file   moved. endless   the
  /// clip goes on without an end in it. Returns its id.
  std::string open_clip(const std::filesystem::path& file, const std::string& name, bool endless);
  /// The same of a clip of a store: one that goes on without an end; or, as_stills, kStillsOfAClip frames of it as the
  /// stills of a scene. clip   its place in the store.
  std::string open_stored_clip(const std::string& store, std::size_t clip, bool as_stills);
  static constexpr std::size_t kStillsOfAClip = 12;

 private:
  WayPlan plan(const std::string& project, const std::string& way);
  /// exported   the name of the file that takes the film; "": it stays in the way's folder.
  JobId submit(const std::shared_ptr<Easel>& easel, const Way& way, const Document& document,
               const WayPlan& plan, const std::string& exported);
  void tell(const std::string& project, const std::string& way);
  std::string open_frame(const cv::Mat& frame, const std::string& name, const std::string& store);

  StudioFolder& folder_;
  Jobs& jobs_;
  Stores& stores_;
  Projects& projects_;
  std::filesystem::path program_;
};

}  // namespace freshet::studio
