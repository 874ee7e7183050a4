#include "library/checks.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet {

void check_range(std::string_view option, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw Error(ErrorKind::kUsage, fmt::format("{} {:g}", option, value), "it is out of range",
                fmt::format("Give {:g} to {:g}", low, high));
}

void check_word(std::string_view option, const std::string& word,
                std::initializer_list<std::string_view> known) {
  if (std::ranges::find(known, word) == known.end())
    throw Error(ErrorKind::kUsage, fmt::format("{} \"{}\"", option, word), "there is no such choice",
                fmt::format("Give one of {}", fmt::join(known, ", ")));
}

}  // namespace freshet
