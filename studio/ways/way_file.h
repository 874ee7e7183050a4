// studio/ways/way_file.h — a file that a way's commands read.
#pragma once

#include <string>

namespace freshet::studio {

struct WayFile {
  std::string name;  // in the way's folder
  std::string bytes;
};

}  // namespace freshet::studio
