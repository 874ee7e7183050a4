// studio/studio.h — the studio without its server: its folder, its stores, its projects, and the work for them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studio/jobs/jobs.h"
#include "studio/projects.h"
#include "studio/stores.h"
#include "studio/studio_folder.h"
#include "studio/ways.h"

namespace freshet::studio {

struct StudioOptions {
  std::filesystem::path folder;               // as StudioFolder has it
  std::vector<std::filesystem::path> stores;  // opened beside those of the folder
  std::filesystem::path program;              // the executable that exports and ingests
};

class Studio {
 public:
  /// Throws as StudioFolder.
  explicit Studio(const StudioOptions& options);
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;
  ~Studio();

  StudioFolder& folder() { return folder_; }
  Jobs& jobs() { return jobs_; }
  Stores& stores() { return stores_; }
  Projects& projects() { return projects_; }
  Ways& ways() { return ways_; }
  /// JSON: "projects", "stores", "folder", the "formats" of an export, the "ranges" of a scene's numbers, the
  /// "pin_reach" that a pin has at first, of the stills' longer side, and what a document holds, px: the
  /// "furthest" that a point may lie, and the "widest" brush.
  std::string home_json() const;

 private:
  StudioFolder folder_;
  Jobs jobs_;
  Stores stores_;
  Projects projects_;
  Ways ways_;
};

}  // namespace freshet::studio
