// What OpenVDB throws, as one line about a file.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <exception>
#include <ios>
#include <new>
#include <string>

#include "isowave/error.h"

namespace isowave {

// One line whatever a library's message holds.
inline std::string oneLine(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
    if (text.size() > 200) text = text.substr(0, 200) + "...";
    return text;
}

// Runs `work` on the file of `length` bytes; whatever OpenVDB and the stream throw becomes an InputError.
template <class Work>
auto vdbGuarded(const std::string& name, std::int64_t length, const Work& work) {
    try {
        return work();
    } catch (const InputError&) {
        throw;
    } catch (const OperationError&) {
        throw;
    } catch (const std::ios_base::failure&) {
        throw InputError(name,
                         fmt::format("ends too early, after {} bytes; it is truncated or damaged", length));
    } catch (const std::bad_alloc&) {
        throw InputError(name,
                         "asks for more memory than there is; it is damaged or too large for this machine");
    } catch (const std::exception& e) {
        throw InputError(name, "is damaged or of an unknown kind: " + oneLine(e.what()));
    }
}

}  // namespace isowave
