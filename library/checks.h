// library/checks.h — options that a program gives, against what the public headers say of them.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace freshet {

/// Throws Error{kUsage} naming the option for a value outside of low..high, or no number.
void check_range(std::string_view option, double value, double low, double high);
/// Throws Error{kUsage} naming the option and what there is for a word that is none of these.
void check_word(std::string_view option, const std::string& word,
                std::initializer_list<std::string_view> known);

}  // namespace freshet
