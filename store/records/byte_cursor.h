// store/records/byte_cursor.h — numbers and strings taken off the front of bytes that are not trusted.
#pragma once

#include "store/format/format.h"

namespace freshet::store {

/// Every length is compared with what is left. After one that does not fit, all that is taken is empty and
/// good() is false.
class ByteCursor {
 public:
  explicit ByteCursor(ByteSpan bytes) : left_(bytes) {}
  template <class T>
  T take() {
    if (left_.size() < sizeof(T)) {
      good_ = false;
      left_ = {};
      return T{};
    }
    const T value = load<T>(left_.data());
    left_ = left_.subspan(sizeof(T));
    return value;
  }
  std::string take_string() {
    const auto size = take<std::uint32_t>();
    if (size > left_.size()) {
      good_ = false;
      left_ = {};
      return {};
    }
    std::string text(reinterpret_cast<const char*>(left_.data()), size);
    left_ = left_.subspan(size);
    return text;
  }
  /// What was taken makes no sense.
  void spoil() { good_ = false; }
  bool good() const { return good_; }
  bool finished() const { return good_ && left_.empty(); }

 private:
  ByteSpan left_;
  bool good_ = true;
};

inline void append_string(Bytes& to, std::string_view text) {
  append(to, static_cast<std::uint32_t>(text.size()));
  const ByteSpan bytes = bytes_of(text);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

}  // namespace freshet::store
