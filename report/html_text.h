// report/html_text.h — text of any kind, as it stands in a page or an attribute.
#pragma once

#include <string>
#include <string_view>

namespace freshet::report {

/// & < > and " as entities; all else as it is (UTF-8).
std::string html_text(std::string_view text);

}  // namespace freshet::report
