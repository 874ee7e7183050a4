// query/benchmark/search_page.h — a search benchmark as one page that needs nothing outside itself.
#pragma once

#include <string>

#include "query/benchmark/search_report.h"

namespace freshet::query {

/// HTML with time against recall@100 drawn twice, whole and from .9 up, every figure as a table below,
/// machine and settings. Light and dark; no script.
std::string search_page(const SearchReport& report);

}  // namespace freshet::query
