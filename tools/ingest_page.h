// tools/ingest_page.h — a page of clips for a person: what was taken of each, what was not, and what would help.
#pragma once

#include <string>

#include "ingest/ingest.h"

namespace freshet::tools {

/// One file that needs no other. The rows have their looks (IngestOptions::pictures).
std::string ingest_page(const std::string& store, const ingest::IngestReport& report);

/// "12.4 s of 31.0 s taken, 3 of 5 clips"; by a preview "would be taken".
std::string taken_text(const ingest::IngestReport& report);

/// "fire", with a "?" where it is not sure; empty where it is not known.
std::string kind_text(const ingest::PartLook& look);

}  // namespace freshet::tools
