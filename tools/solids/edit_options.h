// Options that say what `isowave edit` changes and how; the Python module takes them, too.
#pragma once

#include <string>
#include <vector>

#include "isowave/pyramid.h"
#include "tools/command.h"

namespace isowave::tools {

struct EditChoices {
    std::vector<Edit> edits;  // in the order in which they were given
    EditingOptions how;

    // --add ... --check. The choices stay where they are for as long as the options are used.
    void declare(OptionList& options);

  private:
    void declareEdits(OptionList& options);
    void moveLast(const std::string& by);
};

}  // namespace isowave::tools
