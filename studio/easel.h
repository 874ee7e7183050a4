// studio/easel.h — a project that is being worked on, with all that was computed for it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>

#include "cache/result_cache.h"
#include "freshet/job.h"
#include "studio/drawing/document.h"
#include "studio/drawing/drawn_matte.h"
#include "studio/found_takes.h"
#include "studio/frame_reel.h"
#include "studio/labelled_picture.h"
#include "studio/opened_store.h"
#include "studio/project.h"
#include "studio/ways/live_layers.h"

namespace freshet::studio {

/// Where a matte stands, and the matte.
struct FoundMatte {
  std::uint64_t key = 0;     // matte_key of what it was made from
  std::uint64_t number = 0;  // no other matte of this run has it
  cv::Mat alpha, held;       // CV_8U; empty: none
  std::vector<std::string> notices;
};

/// Safe from many threads; bring_up_to_date from one at a time, and so show_layers.
class Easel {
 public:
  /// tell   is given news for the page: a type and JSON.
  using Tell = std::function<void(const std::string& type, const std::string& data)>;
  Easel(std::shared_ptr<Project> project, Tell tell);

  Project& project() const { return *project_; }

  /// Matte, field, first preview, labels, full preview: what the document has changed is made anew, in this order, and
  /// told as it is there; at the end "settled", with the full preview that stands, if any: one that was begun for a
  /// change that was taken back is not waited for. store   null: none is chosen. cache   may be null.
  /// Throws Error{kCancelled}; whatever else is wrong is told as "problem", and kept in overview_json().
  void bring_up_to_date(OpenedStore* store, cache::ResultCache* cache, const Job& job);

  std::shared_ptr<const FoundMatte> matte() const;
  std::shared_ptr<const LabelledPicture> labelled() const;
  /// Whether the labels are those of this document.
  bool is_labelled(const Document& document) const;
  /// Makes the takes of the animation that is there (found_takes.h), and tells "takes". Throws Error{kNotFound} before
  /// there is any, and as studio::find_takes.
  void find_takes(const Job& job);
  std::shared_ptr<const FoundTakes> takes() const;  // the last ones; null: none were asked for
  /// Rolls the scene in layers, reduced, from frame `first` on and round (LiveLayers), and tells "layers": its
  /// reel, or what is wrong with it. Throws Error{kCancelled}.
  void show_layers(int first, const Job& job);
  /// By its number, of those that are kept.
  std::shared_ptr<const FrameReel> reel(std::uint64_t number) const;

  /// The motion that the strokes ask, or else that was assigned, on a coarse grid, for the page; "null" before there is
  /// any.
  std::string field_json() const;
  /// What there is: matte, reels, labels, problem.
  std::string overview_json() const;
  /// JPEG of a part of the picture, its longer side at most so many px. part   px; cut at the picture's edges; empty:
  /// all of it. Throws Error{kNotFound} for a part beside the picture.
  std::string picture_jpeg(const cv::Rect& part, int longest) const;
  /// What looks as if it stood in the matte and is not held yet (vision::what_stands): outlines, the largest first,
  /// each x0, y0, x1, y1, .. px of the picture. Throws Error{kNotFound} before there is a matte.
  std::string standing_json() const;
  /// What a click takes (vision::what_lies_at): whether it is to be held or let go, and outlines as above.
  /// asked   x, y: px. size: times what a plain click takes. held: the marks of what is held.
  /// Throws  Error{kNotFound} before there is a matte, and for a point beside the picture; Error{kInput} as Fields.
  std::string lying_json(const nlohmann::json& asked) const;
  /// PNG, white, with the matte as its alpha.
  std::string matte_png(const cv::Mat& alpha, int longest) const;

 private:
  struct Results {
    std::shared_ptr<const FoundMatte> matte;
    std::shared_ptr<const LabelledPicture> labelled;
    std::uint64_t labels_key = 0, frames_key = 0;  // of what is there; 0: nothing
    std::shared_ptr<FrameReel> small, full, layers;
    std::shared_ptr<const FoundTakes> takes;
    std::string field = "null", problem;
  };
  void work(const Document& document, OpenedStore* store, cache::ResultCache* cache, const Job& job);
  std::shared_ptr<const FoundMatte> find_matte(const Document& document, const Job& job);
  void keep_matte(const Document& document, DrawnMatte drawn, Care care);
  void tell_field(const Document& document);
  void render_small(const Document& document, const FoundMatte& matte,
                    const std::shared_ptr<const StoreBase>& base, const Job& job);
  std::shared_ptr<const LabelledPicture> find_labels(const Document& document, const FoundMatte& matte,
                                                     const std::shared_ptr<const StoreBase>& base,
                                                     cache::ResultCache* cache, const Job& job);
  void render_full(const Document& document, const FoundMatte& matte, const LabelledPicture& labelled,
                   const Job& job);
  ReelScene full_scene(const Document& document, const FoundMatte& matte,
                       const LabelledPicture& labelled) const;
  void roll(const std::shared_ptr<FrameReel>& reel,
            const std::function<void(const std::function<void()>&)>& frames);
  void tell_problem(const std::string& text);
  void tell_settled(const Document& document);
  Results results() const;

  std::shared_ptr<Project> project_;
  Tell tell_;
  mutable std::mutex guard_;
  Results results_;
  LiveLayers live_layers_;
};

}  // namespace freshet::studio
