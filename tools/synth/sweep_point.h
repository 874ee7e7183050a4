// tools/synth/sweep_point.h — the points of a sweep: sets of freshet synth animate's own arguments.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/synth/animate_command.h"

namespace freshet::tools {

/// What stands for "without this option" among an axis's values.
inline constexpr const char* kWithout = "-";
inline constexpr std::size_t kMaxPoints = 64;

/// Of animate's options all but those that name its outputs: a sweep has its own, and nothing else can be varied.
void add_varied_to(CLI::App& app, AnimateCommand& command);

/// One --vary: an option of animate, and the values that it takes.
struct SweepAxis {
  std::string name;                 // "speed"
  std::string description;          // the option's own
  std::vector<std::string> values;  // as they were written, for a person
  /// Of each value, the words of animate's command line: "--speed=2"; "--exclude=a", "--exclude=b".
  std::vector<std::vector<std::string>> words;
};

/// "speed=0.5,1,2"; "exclude=-,a.mp4,a.mp4+b.mp4": commas part values, "+" what one value gives an option that may
/// be given several times; a backslash takes either as it stands.
/// animate   a command line with the options that may be varied; of them nothing else is read.
/// Throws    Error{kUsage} saying what is wrong with the text: no "=", no such option, no value, one given twice.
SweepAxis parse_axis(const std::string& text, const CLI::App& animate);

/// One combination, parsed as animate parses its command line.
class SweepPoint {
 public:
  /// words    of animate's command line, but for its output.
  /// output   without an ending: that follows from the words.
  /// Throws   Error{kUsage} naming the settings, for words that animate refuses.
  SweepPoint(std::vector<std::pair<std::string, std::string>> settings, std::vector<std::string> words,
             const std::string& output);

  AnimateCommand& command() { return *command_; }
  /// Option and value of each axis.
  const std::vector<std::pair<std::string, std::string>>& settings() const { return settings_; }
  /// Of animate's command line, but for its output.
  const std::vector<std::string>& words() const { return words_; }
  /// "speed 2, without strokes".
  std::string title() const;
  /// What a person types to make it alone, ready for a shell.
  std::string command_line() const;
  /// Its options that work on the patches chosen and the files read, as they are parsed, given or by default: points
  /// for which all three are equal are one animation. "--speed=2".
  std::vector<std::string> rendering_words() const;

 private:
  std::vector<std::pair<std::string, std::string>> settings_;
  std::vector<std::string> words_;
  std::unique_ptr<CLI::App> app_;  // which the command's options refer to
  std::unique_ptr<AnimateCommand> command_;
};

/// The product of all axes, the last one changing fastest.
/// given    animate's command line as it was parsed for all points. Throws Error{kUsage} for an option that is both
///          given and varied, for an axis given twice, for more than kMaxPoints, and as SweepPoint.
/// folder   of the outputs, "01", "02", ...; or of a folder of each, "01/01", ...
std::vector<SweepPoint> make_points(const std::vector<SweepAxis>& axes, const CLI::App& given,
                                    const std::string& folder, bool a_folder_each = false);
/// "01".
std::string number_of(std::size_t point);

}  // namespace freshet::tools
