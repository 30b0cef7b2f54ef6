// What was thrown -> exit code and the one line.
#pragma once

#include <exception>
#include <string>

namespace isowave::tools {

struct Failure {
    int exitCode = 1;     // of the table in help.h
    std::string message;  // one line, without "isowave: "
};

Failure failureOf(const std::exception_ptr& thrown);

}  // namespace isowave::tools
