// What a refusal says.
#pragma once

#include <string>

#include "isowave/error.h"

namespace isowave::subdivision {

// The line of the InputError that work() throws; "" when it throws none.
template <class Work>
std::string complaint(const Work& work) {
    try {
        work();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace isowave::subdivision
