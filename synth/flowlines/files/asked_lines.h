// synth/flowlines/files/asked_lines.h — what a person says of flow lines: drawings, pictures and words.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "synth/flowlines/flowlines.h"
#include "synth/flowlines/footage.h"

namespace freshet::synth::flowlines {

/// "auto", "stationary", "non-stationary". Each throws Error{kUsage} for another word.
Dynamics parse_dynamics(std::string_view word);
/// "cut", "feather", "contrast".
Mixing parse_mixing(std::string_view word);
/// "equal", "stretched".
Correspondence parse_correspondence(std::string_view word);

/// Files over a clip; each may be empty.
struct AskedLines {
  std::filesystem::path lines{}, edited{};  // as read_lines reads them
  std::filesystem::path matte{};            // a grey picture, white where lines are allowed
  std::filesystem::path background{};       // a picture of what lies behind fluid that is taken away
};

/// Reads them into the options; lines shorter than half a patch are left out.
/// notices   for a person, each with its file.
/// Throws    Error{kInput} naming the file: as read_lines and read_matte; a background of another size.
void read_asked(const AskedLines& asked, const Footage& footage, FlowlinesOptions& options,
                std::vector<std::string>& notices);

}  // namespace freshet::synth::flowlines
