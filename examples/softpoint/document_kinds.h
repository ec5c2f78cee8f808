#pragma once

#include <string>
#include <vector>

#include "schema.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A kind of document that the program reads.
struct DocumentKind {
  std::string command;  // the subcommand that reads it
  std::string title;
  Schema schema;
};

std::vector<DocumentKind> document_kinds();

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
