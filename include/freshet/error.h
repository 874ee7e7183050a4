// include/freshet/error.h — the one error type: what a file, a user or a machine can cause.
#pragma once

#include <stdexcept>
#include <string>

namespace freshet {

/// What went wrong, as far as a caller or a shell script wants to tell apart.
enum class ErrorKind {
  kUsage,      // wrong use of a command or a function: exit code 2
  kInput,      // a file of the user's that is missing, unreadable or unfit: 1
  kIo,         // the machine refused: disk full, no permission, out of memory: 1
  kDamaged,    // a store whose bytes are not what was written: 3
  kNotFound,   // something asked for is not in the store: 1
  kCancelled,  // stopped by the user: dies of the signal
};

/// Thrown by every room. what() reads "WHERE: FAULT. REMEDY" and is fit to be shown to a person.
class Error : public std::runtime_error {
 public:
  /// where    the file, record or option at fault.
  /// fault    what was found, and what was expected.
  /// remedy   what the user can do; may be empty where nothing can be done.
  Error(ErrorKind kind, const std::string& where, const std::string& fault, const std::string& remedy = {})
      : std::runtime_error(where + ": " + fault + (remedy.empty() ? "." : ". " + remedy + ".")),
        kind_(kind) {}

  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace freshet
