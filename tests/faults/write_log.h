// tests/faults/write_log.h — kinds of entries in the log that the preloaded library write_log.cc writes.
#pragma once

namespace freshet::tools {

enum class LogKind : unsigned char { kWrite, kTruncate, kSync, kRename };

}  // namespace freshet::tools
