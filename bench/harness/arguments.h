// bench/harness/arguments.h — the arguments of a bench. CLI11, of which each unit takes seconds to compile, reads them
// in one unit.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace freshet::bench {

class Arguments {
 public:
  class Option {
   public:
    explicit Option(CLI::Option& option) : option_(&option) {}
    Option& required();
    Option& split_at(char delimiter);  // one argument holds several values
    Option& one_each();                // one value an argument, which may be repeated
    Option& at_least(double low);
    Option& between(double low, double high);
    Option& one_of(const std::vector<std::string>& values);
    Option& existing_file();
    Option& existing_folder();
    /// fault   What is wrong with a value; empty: nothing.
    Option& checked(const std::function<std::string(const std::string&)>& fault);

   private:
    CLI::Option* option_;
  };

  /// question   What the bench asks, for --help.
  explicit Arguments(const std::string& question);
  ~Arguments();

  /// A name without dashes: by its place. What the value is beforehand is shown as the default, but for an empty one.
  /// Value   int, unsigned, std::size_t, std::uint64_t, double, std::string, std::filesystem::path, a vector of int,
  ///         std::size_t, double, std::string or std::filesystem::path, a set of std::string.
  template <class Value>
  Option option(const std::string& name, Value& value, const std::string& help = {});
  void flag(const std::string& name, bool& value, const std::string& help);
  /// Ends the program where help is asked for (0) or an argument is wrong, saying so.
  void parse(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace freshet::bench
