// report/data_address.h — bytes as an address, for pages that need no other file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace freshet::report {

/// "data:image/jpeg;base64,..." (RFC 2397, 4648).
std::string data_address(std::string_view type, std::span<const std::uint8_t> bytes);

}  // namespace freshet::report
