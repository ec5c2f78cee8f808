#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "command.h"
#include "document_kinds.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

struct SchemaOptions {
  std::string command;
  bool markdown = false;
};

int schema(const SchemaOptions& options) {
  for (const DocumentKind& kind : document_kinds()) {
    if (!options.command.empty() && options.command != kind.command) {
      continue;
    }
    if (options.markdown) {
      fmt::print("### {}\n\n{}\n", kind.title, schema_markdown(kind.schema));
    } else {
      fmt::print("{}\n\n{}\n", kind.title, schema_text(kind.schema));
    }
  }
  return kExitDone;
}

}  // namespace

Command add_schema_command(CLI::App& program) {
  auto options = std::make_shared<SchemaOptions>();
  CLI::App* app = program.add_subcommand("schema", "Print what the documents may hold");
  std::vector<std::string> names;
  for (const DocumentKind& kind : document_kinds()) {
    names.push_back(kind.command);
  }
  app->add_option("COMMAND", options->command, "Only the documents of this command")
      ->check(CLI::IsMember(names));
  app->add_flag("--markdown", options->markdown, "Print tables in Markdown");
  return {app, [options] { return schema(*options); }};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
