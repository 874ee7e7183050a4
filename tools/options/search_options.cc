#include "tools/options/search_options.h"

#include "freshet/error.h"
#include "query/search/picture_scale.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void SearchOptions::add_to(CLI::App& command) {
  command.add_option(
      "--class", options_.class_name,
      "Only clips of this class (see freshet store info), or any: of all [the class that the picture looks "
      "most like; all where the store lacks it]");
  command.add_option(
      "--direction", direction_,
      "Direction of the flow: up, down, left, right, up-left, ..., or degrees (0 right, 90 up) [any]");
  tolerance_option_ =
      command
          .add_option("--tolerance", options_.direction_tolerance_deg,
                      "Tolerance of the direction in a narrow search (--hint-search), degrees to either side")
          ->check(CLI::Range(1.0, 180.0))
          ->capture_default_str()
          ->group(in_detail("Search"));
  command.add_option("-k,--candidates", options_.k, "Number of candidates for each piece")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str()
      ->group(in_detail("Search"));
  command
      .add_option("--coherent", options_.coherent,
                  "Number of each neighbour's best candidates that are continued into a piece's list")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str()
      ->group(in_detail("Search"));
  command.add_option("--min-scale", options_.min_scale, "Smallest scale of the patches")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group(in_detail("Search"));
  command.add_option("--max-rotation", options_.max_rotation_deg, "Largest rotation of the patches, degrees")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str()
      ->group(in_detail("Search"));
  command.add_option("--exclude", options_.excluded_clips, "Clip to exclude; may be given several times");
  command
      .add_option(
          "--piece-scale", piece_scale_,
          "Divisor of the picture's sides before it is cut into pieces, 1 to 16; patches are enlarged by it. "
          "auto: a longer side near 1280 px (1 below 1600 px, 1.5 at 1920, 3 at 3840)")
      ->check(CLI::IsMember({"auto"}) | CLI::Range(1.0, query::kMaxPieceScale))
      ->capture_default_str()
      ->group(in_detail("Search"));
  command
      .add_option("--index", index_,
                  "exact, or a FLANN index of the store: freshet ingest makes flann-hierarchical, "
                  "freshet index --flann the others")
      ->check(CLI::IsMember({"exact", "flann-kdtree", "flann-kmeans", "flann-hierarchical"}))
      ->capture_default_str()
      ->group(in_detail("Search"));
  checks_option_ =
      command
          .add_option("--checks", flann_options_.checks,
                      "Number of patches that a FLANN index looks at; more finds more and takes longer. 0: "
                      "enough for a recall@100 of .9")
          ->check(CLI::Range(0, 1 << 24))
          ->capture_default_str()
          ->group(in_detail("Search"));
}

query::CandidateOptions SearchOptions::options() const {
  query::CandidateOptions options = options_;
  if (!direction_.empty()) options.direction_deg = query::parse_direction(direction_);
  return options;
}

std::optional<double> SearchOptions::piece_scale() const {
  if (piece_scale_ == "auto") return std::nullopt;
  return std::stod(piece_scale_);
}

void SearchOptions::check(const store::Snapshot& snapshot) const {
  // Without a command nobody gave it.
  if (checks_option_ != nullptr && checks_option_->count() > 0 && index_ == "exact")
    throw Error(ErrorKind::kUsage, "--checks", "the exact index looks at all patches",
                "Add --index with one of FLANN's, or leave it out");
  query::check_names(snapshot, options_);
}

query::IndexChoice SearchOptions::index() const {
  query::IndexChoice choice{.flann = {}, .flann_options = flann_options_};
  if (index_ != "exact") choice.flann = query::parse_flann_kind(index_.substr(std::string("flann-").size()));
  return choice;
}

}  // namespace freshet::tools
