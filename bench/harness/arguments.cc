#include "bench/harness/arguments.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>

namespace freshet::bench {

using Option = Arguments::Option;

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::split_at(char delimiter) {
  option_->delimiter(delimiter);
  return *this;
}

Option& Option::one_each() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::at_least(double low) { return between(low, std::numeric_limits<double>::max()); }

Option& Option::between(double low, double high) {
  option_->check(CLI::Range(low, high));
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& values) {
  option_->check(CLI::IsMember(values));
  return *this;
}

Option& Option::existing_file() {
  option_->check(CLI::ExistingFile);
  return *this;
}

Option& Option::existing_folder() {
  option_->check(CLI::ExistingDirectory);
  return *this;
}

Option& Option::checked(const std::function<std::string(const std::string&)>& fault) {
  option_->check(fault);
  return *this;
}

Arguments::Arguments(const std::string& question) : app_(std::make_unique<CLI::App>(question)) {}

Arguments::~Arguments() = default;

template <class Value>
Option Arguments::option(const std::string& name, Value& value, const std::string& help) {
  CLI::Option& made = *app_->add_option(name, value, help);
  if constexpr (std::is_arithmetic_v<Value>)
    made.capture_default_str();
  else if (!value.empty())
    made.capture_default_str();
  return Option(made);
}

template Option Arguments::option(const std::string&, int&, const std::string&);
template Option Arguments::option(const std::string&, unsigned&, const std::string&);
template Option Arguments::option(const std::string&, std::uint64_t&, const std::string&);
template Option Arguments::option(const std::string&, double&, const std::string&);
template Option Arguments::option(const std::string&, std::string&, const std::string&);
template Option Arguments::option(const std::string&, std::filesystem::path&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<int>&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<std::uint64_t>&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<double>&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Arguments::option(const std::string&, std::vector<std::filesystem::path>&,
                                  const std::string&);
template Option Arguments::option(const std::string&, std::set<std::string>&, const std::string&);

void Arguments::flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

void Arguments::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& fault) {
    std::exit(app_->exit(fault));
  }
}

}  // namespace freshet::bench
