// tools/console/numbers.h — numbers on the command line, or in a file of options, that are none.
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

namespace freshet::tools {

/// "nan" is a number to the C library and lies outside no range: every comparison with it is false; and -1, where no
/// sign is wanted, wraps to the largest. Throws Error{kUsage} where an option that takes a number was given one of
/// these, or infinity. Call it when all has been parsed.
void refuse_non_numbers(const CLI::App& app);

/// WIDTHxHEIGHT. Throws CLI::ValidationError naming --size.
cv::Size parse_size(const std::string& text);

}  // namespace freshet::tools
