// studio/project.h — a folder with a picture and all that was drawn for it, kept while one draws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "media/picture/picture.h"
#include "studio/beneath.h"
#include "studio/drawing/document.h"
#include "studio/drawing/recipe.h"
#include "studio/ways/way_file.h"

namespace freshet::studio {

/// Files in it:
///   picture.*        as it was given
///   document.json    what was drawn and chosen
///   project.toml     the same for the command line, with strokes.svg, matte.png, hold.png, tempo.png, assignment.json
///                    beside it
///   marks.json       the scribbles, for `synth matte --marks`
///   history.json     what can be undone, as the page keeps it
///   thumbnail.jpg    the picture, small
///   exports/         what was made
///   ways/            what other ways to synthesise were given, and made of it
/// Each is written beside its place and renamed. Safe from many threads.
class Project {
 public:
  /// Makes the folder of a picture; it must not be there. bytes   moved into it.
  /// Throws Error{kInput} when they are no picture that can be read: nothing is left then.
  static std::shared_ptr<Project> create(const std::filesystem::path& folder,
                                         const std::filesystem::path& bytes, const std::string& ending);
  /// One that is there. A document that cannot be read is put aside (document.damaged), and said in notice().
  /// Throws Error{kInput} when it is no project's folder, or a symbolic link.
  explicit Project(std::filesystem::path folder);

  std::string id() const { return folder_.filename().string(); }
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& notice() const { return notice_; }

  struct State {
    Document document;
    std::uint64_t version = 0;  // counts the changes since the project was opened
  };
  State state() const;
  /// Written when it returns. Nothing: somebody else has changed it since `base`. Throws Error{kIo}.
  std::optional<std::uint64_t> save(const Document& document, std::uint64_t base);

  /// Read when it is first asked for. Throws as media::read_still.
  std::shared_ptr<const media::Still> picture() const;
  cv::Size size() const;
  const std::string& picture_file() const { return picture_file_; }
  /// A matte that was given; empty: none. Throws as media::read_matte.
  cv::Mat given_matte() const;
  /// Takes it over. Throws Error{kInput} when it is none of this picture's.
  void give_matte(const std::filesystem::path& bytes);

  /// What the page can undo: JSON that means nothing to us. "null": nothing. Throws Error{kInput} for what is no JSON,
  /// or more than 4 MB.
  void write_history(std::string_view json);
  std::string history() const;

  /// Writes what was found; what is empty is removed.
  void write_mattes(const cv::Mat& alpha, const cv::Mat& held);
  void write_tempo(const cv::Mat& map);
  void write_assignment(const std::string& json);
  void write_recipe(const Document& document);
  /// Which of these files there are.
  RecipeFiles recipe_files(const Document& document) const;

  /// Writes files into ways/WAY, which is made. Throws Error{kIo} where a link is on the way.
  void write_way(const std::string& way, const std::vector<WayFile>& files) const;
  /// A file of ways/WAY. Throws Error{kNotFound}, for links too.
  std::shared_ptr<const OpenFile> open_way(const std::string& way, const std::string& name) const;
  std::string read_way(const std::string& way, const std::string& name) const;

  /// Makes exports/, for a file of this name. Throws Error{kUsage} for a name that is no plain file name, or a link's.
  void expect_export(const std::string& name) const;
  /// exports/NAME. Throws Error{kNotFound}, for links too.
  std::shared_ptr<const OpenFile> open_export(const std::string& name) const;
  /// What `synth animate -o` is told for it, from the project's folder: "exports/fall.mp4"; for a sequence, of
  /// pictures, "exports/fall/fall.####.exr".
  static std::string export_output(const std::string& name);

 private:
  void write(const std::string& name, std::string_view bytes) const;
  void write_or_remove(const char* name, const cv::Mat& map) const;
  bool holds(const std::string& name) const;
  RecipeFiles files_of(const Document& document) const;  // the guard is held
  void read_document();

  std::filesystem::path folder_;
  std::string picture_file_, notice_;
  mutable std::mutex guard_;
  State state_;
  bool whole_ = false;  // the matte is white everywhere, which the command line wants in another way
  mutable std::mutex picture_guard_;
  mutable std::shared_ptr<const media::Still> picture_;
};

/// The bytes of a project's thumbnail, without opening it. Throws Error{kNotFound}.
std::string thumbnail(const std::filesystem::path& folder);

/// A picture (CV_8UC3) as JPEG, its longer side at most `side` px.
std::string small_jpeg(const cv::Mat& picture, int side);

/// "A fall, 3.JPG" becomes "a-fall-3".
std::string project_name(const std::string& file);
/// Whether it is one that project_name could give: nothing that leads elsewhere.
bool is_project_name(std::string_view name);
/// A file name that means nothing to a file system or a shell: letters, digits, "._-", not beginning with a dot.
bool is_plain_file_name(std::string_view name);

}  // namespace freshet::studio
