// studio/drawing/fields.h — the fields of a JSON object that a page sent, each checked as it is taken.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "studio/drawing/drawn.h"

namespace freshet::studio {

inline constexpr std::size_t kMaxLines = 20000;  // of one list of lines

/// Takes fields out of an object. Everything throws Error{kInput} that names the object and the field.
class Fields {
 public:
  /// points   counts those of the whole document, which are bounded together. It and the object must outlive this.
  Fields(const nlohmann::json& object, std::string where, std::size_t& points);

  [[noreturn]] void fail(const std::string& fault) const;
  /// Fails where there are others.
  void only(const std::set<std::string>& names) const;
  bool has(const char* name) const { return object_.contains(name); }
  const nlohmann::json& at(const char* name) const;
  double number(const char* name, double low, double high) const;
  int integer(const char* name, int low, int high) const;
  bool flag(const char* name) const;
  /// At most 4096 bytes, without control characters.
  std::string text(const char* name) const;
  /// One of these words.
  std::string word(const char* name, const std::vector<std::string>& words) const;
  const nlohmann::json& list(const char* name, std::size_t most) const;
  /// Of an item of a list, or of an object within this one.
  Fields below(const nlohmann::json& item, const char* name, std::size_t index) const;
  /// Its "points", one or more.
  std::vector<cv::Point2f> points() const;
  std::vector<Drawn> drawn(const char* name) const;
  std::vector<DrawnStroke> strokes(const char* name) const;

 private:
  const nlohmann::json& object_;
  std::string where_;
  std::size_t& points_;
};

nlohmann::json points_json(const std::vector<cv::Point2f>& points);
nlohmann::json drawn_json(const std::vector<Drawn>& lines);
nlohmann::json strokes_json(const std::vector<DrawnStroke>& strokes);

}  // namespace freshet::studio
