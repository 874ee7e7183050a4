// studio/http/routes.h — what a page can ask of the studio: one row for each path.
#pragma once

#include <vector>

#include "studio/http/call.h"
#include "studio/studio.h"

namespace freshet::studio {

/// The studio must outlive them. Their handlers throw what the studio throws.
std::vector<Route> project_routes(Studio& studio);
std::vector<Route> way_routes(Studio& studio);
std::vector<Route> store_routes(Studio& studio);
std::vector<Route> job_routes(Studio& studio);

}  // namespace freshet::studio
