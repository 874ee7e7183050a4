// platform/open_remedy.h — what to do about a file that could not be opened.
#pragma once

#include <cerrno>
#include <string>

namespace freshet {

/// code    errno. usual   The remedy, unless the process or the machine has no descriptor left.
inline std::string open_remedy(int code, const char* usual) {
  return code == EMFILE || code == ENFILE
             ? "Raise the limit of open files (ulimit -n), or close programs, and run again"
             : usual;
}

}  // namespace freshet
