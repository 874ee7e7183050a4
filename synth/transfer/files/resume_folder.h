// synth/transfer/files/resume_folder.h — what an unfinished run leaves, so that the next goes on from there.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// A folder beside an output:
///   job.json          what is being made, and of what
///   frames.json       what was found out about each frame
///   state             of the transfer after the last whole frame
///   frame_00000.png   the frames, 16 bits, for outputs that are one file
/// A frame counts when the state after it has been written. Each file is written beside itself and renamed,
/// so that a kill at any moment leaves the frame before it.
class ResumeFolder {
 public:
  /// OUT.resume; for a pattern what stands before the number, and frames.resume: shot/f.%05d.png has
  /// shot/f.frames.resume.
  static std::filesystem::path beside(const std::filesystem::path& output);

  /// Opens the folder, and makes it where it is not there.
  /// job      all that decides the result. restart: what is there is removed first.
  /// Throws   Error{kUsage} when what is there was begun for another job, naming the first key in which they
  ///          differ; Error{kIo} when no folder can be made.
  ResumeFolder(const std::filesystem::path& folder, const nlohmann::json& job, bool restart);

  /// Brings the transfer to where the state was kept, and returns the notes of the frames that are whole; an
  /// empty array when there is none.
  nlohmann::json resume(Transfer& transfer) const;
  /// The frame just made is whole: notes has one entry for each so far.
  void keep(const Transfer& transfer, const nlohmann::json& notes) const;

  const std::filesystem::path& path() const { return folder_; }
  /// Removes all of it: the output is whole.
  void remove() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace freshet::synth::transfer
