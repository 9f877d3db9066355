#include "saccade/core/errors.hpp"
#include "view_page.hpp"

namespace saccade::app {

std::vector<PageFile> viewPage() {
  throw IoError("saccade view", "a program that was built with its page, for which CMake needs node and npm",
                "one that was built without: install the Debian packages nodejs and npm and build again");
}

}  // namespace saccade::app
