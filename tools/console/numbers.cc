#include "tools/console/numbers.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "freshet/error.h"

namespace freshet::tools {

void refuse_non_numbers(const CLI::App& app) {
  for (const CLI::App* command = &app; command != nullptr;) {
    for (const CLI::Option* option : command->get_options()) {
      const std::string type = option->get_type_name();
      if (type.find("UINT") != std::string::npos)
        for (const std::string& value : option->results())
          if (value.starts_with('-'))
            throw Error(ErrorKind::kUsage, option->get_name() + " " + value, "it is below 0",
                        "Give a number from 0 on");
      if (type.find("FLOAT") == std::string::npos && type.find("NUMBER") == std::string::npos) continue;
      for (const std::string& value : option->results()) {
        char* end = nullptr;
        const double number = std::strtod(value.c_str(), &end);
        if (end != value.c_str() && !std::isfinite(number))
          throw Error(ErrorKind::kUsage, option->get_name() + " " + value, "it is not a number",
                      "Give one, such as 1 or 0.5");
      }
    }
    const auto below = command->get_subcommands();
    command = below.empty() ? nullptr : below.front();
  }
}

cv::Size parse_size(const std::string& text) {
  int width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2)
    throw CLI::ValidationError("--size", "expected WIDTHxHEIGHT, for example 640x360, not " + text);
  return {width, height};
}

}  // namespace freshet::tools
