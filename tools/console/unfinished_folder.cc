#include "tools/console/unfinished_folder.h"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "freshet/error.h"

namespace freshet::tools {

UnfinishedFolder::UnfinishedFolder(const std::filesystem::path& parent, const char* prefix) {
  std::error_code fault;
  std::filesystem::create_directories(parent, fault);
  std::string name = (parent / prefix).string() + "XXXXXX";
  if (mkdtemp(name.data()) == nullptr)
    throw Error(ErrorKind::kIo, name, std::string("cannot be made (") + std::strerror(errno) + ")",
                "Name another place");
  path_ = name;
}

UnfinishedFolder::~UnfinishedFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace freshet::tools
