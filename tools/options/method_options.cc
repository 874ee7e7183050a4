#include "tools/options/method_options.h"

#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"
#include "synth/animate/method_settings.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

namespace animate = synth::animate;

void MethodOptions::add_to(CLI::App& command) {
  const std::vector<animate::MethodSetting>& settings = animate::method_settings();
  const std::size_t methods = animate::methods_with(settings.front()).size();
  given_.assign(settings.size(), "");
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const animate::MethodSetting& setting = settings[i];
    if (!setting.for_commands) continue;
    const std::vector<std::string> of = animate::methods_with(setting);
    const std::string text = of.size() == methods
                                 ? setting.text
                                 : fmt::format("{} (with --method {})", setting.text, fmt::join(of, ", "));
    CLI::Option* const option =
        setting.words.empty()
            ? command
                  .add_option_function<double>(
                      "--" + setting.name,
                      [this, i](double number) { given_[i] = fmt::format("{}", number); }, text)
                  ->check(CLI::Range(setting.min, setting.max))
            : command
                  .add_option_function<std::string>(
                      "--" + setting.name, [this, i](const std::string& word) { given_[i] = word; }, text)
                  ->check(CLI::IsMember(setting.words));
    option->default_str(animate::default_value(setting))->group(in_detail("Rendering"));
  }
}

animate::Method MethodOptions::method() const {
  const std::vector<animate::MethodSetting>& settings = animate::method_settings();
  animate::Method method;
  for (std::size_t i = 0; i < given_.size(); ++i) {
    if (given_[i].empty()) continue;
    if (!settings[i].value(method))
      throw Error(ErrorKind::kUsage, "--" + settings[i].name,
                  fmt::format("--method {} does without it", animate::method_name(method)),
                  fmt::format("Add --method {}, or leave it out",
                              fmt::join(animate::methods_with(settings[i]), ", ")));
    settings[i].set(method, given_[i]);
  }
  return method;
}

}  // namespace freshet::tools
