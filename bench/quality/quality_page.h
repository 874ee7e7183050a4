// quality_page.h — the films themselves, real, made and still beside each other, on one page that plays them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/quality/quality_case.h"
#include "bench/quality/quality_report.h"

namespace freshet::bench {

/// Three panels: what was filmed, what was made, the still with the matte's outline and the strokes.
/// folder   must exist. Returns the file's name in it, an .mp4 made of the clip's and method's names.
std::string write_panels(const std::filesystem::path& folder, const Case& asked,
                         const std::vector<cv::Mat>& made, const std::string& method, bool with_strokes);

/// folder/CLIP/METHOD.mp4, names of the clip and method in letters, digits and _; as large as the still, at the clip's
/// rate.
void write_film(const std::filesystem::path& folder, const Case& asked, const std::string& method,
                const std::vector<cv::Mat>& frames);

/// index.html: a card for each judged entry that has a video, sorted by any figure on a click (spectrum
/// first, worst first), and the tables. It refers to nothing outside its folder.
void write_page(const std::filesystem::path& folder, const std::vector<Judged>& judged,
                const std::string& title);

}  // namespace freshet::bench
