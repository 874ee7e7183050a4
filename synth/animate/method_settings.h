// synth/animate/method_settings.h — the settings of how frames are made, a row each: name, effect, range, field.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "synth/animate/animate.h"

namespace freshet::synth::animate {

/// One field of the methods' options, for whoever asks a person for it: the command line, a sweep, a bench.
struct MethodSetting {
  std::string name;                // "renewal": --renewal of the command line
  std::string text;                // effect, unit
  double min = 0, max = 0;         // of a number, inclusive
  std::vector<std::string> words;  // one of these, in place of a number; empty: a number
  bool for_commands = true;        // else for benches alone

  /// The field as text; nothing where the method has none such.
  std::function<std::optional<std::string>(const Method&)> value;
  /// Throws Error{kUsage} naming the setting: no number, out of range, no such word, or a method without it.
  void set(Method& method, const std::string& given) const;

  std::function<bool(Method&, const std::string&)>
      put{};  // of a value that is right; false where the method has none
};

/// "method" first: it gives all others the defaults of the method that it names.
const std::vector<MethodSetting>& method_settings();
/// Throws Error{kUsage} for a name that is none.
const MethodSetting& method_setting(const std::string& name);
/// "carried", "forms", "paper".
std::string method_name(const Method& method);
/// The defaults of the first method that has the setting.
std::string default_value(const MethodSetting& setting);
/// Names of the methods that have it.
std::vector<std::string> methods_with(const MethodSetting& setting);

}  // namespace freshet::synth::animate
