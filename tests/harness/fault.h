// tests/harness/fault.h — what something throws.
#pragma once

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "freshet/error.h"

namespace freshet {

/// The kind of the Error that an action throws; nothing where it throws none.
template <class Action>
std::optional<ErrorKind> kind_of(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.kind();
  }
  return std::nullopt;
}

/// What the Error says that an action throws. Fails the test when it throws none, or one of another kind.
template <class Action>
std::string fault_of(ErrorKind kind, Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}
/// Of a file of the user's, as most are.
template <class Action>
std::string fault_of(Action&& action) {
  return fault_of(ErrorKind::kInput, action);
}

}  // namespace freshet
