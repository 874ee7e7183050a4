// bench/transfer/transfer_page.h — what bench_transfer measured, as curves on one page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace freshet::bench {

/// One self-contained page without pictures: by exemplar the sharpness, colours and change of every frame,
/// all methods in a chart; the promises, counted; the cost curve where it was measured.
/// result  as bench_transfer writes it: "machine", "runs", "curve".
std::string transfer_page(const nlohmann::json& result);

}  // namespace freshet::bench
