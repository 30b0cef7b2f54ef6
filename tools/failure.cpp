#include "tools/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <new>

#include "isowave/error.h"
#include "isowave/progress.h"

namespace isowave::tools {
namespace {

Failure sorted(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const UsageError& error) {
        return {2, error.what()};
    } catch (const InputError& error) {
        return {3, error.what()};
    } catch (const Cancelled&) {
        return {130, "interrupted; nothing was left behind"};
    } catch (const OperationError& error) {
        return {1, error.what()};
    } catch (const std::bad_alloc&) {
        return {1, "memory did not suffice; take fewer voxels or free some memory"};
    } catch (const std::filesystem::filesystem_error& error) {
        // A name that is too long or leads to itself, most likely of an input.
        return {1, fmt::format("{}: {}", error.path1().string(), error.code().message())};
    } catch (const std::exception& error) {
        return {1, fmt::format("failed: {}", error.what())};
    }
}

}  // namespace

Failure failureOf(const std::exception_ptr& thrown) {
    Failure failure = sorted(thrown);
    std::replace(failure.message.begin(), failure.message.end(), '\n', ' ');
    return failure;
}

}  // namespace isowave::tools
