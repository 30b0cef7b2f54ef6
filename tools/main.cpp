// isowave: one subcommand, one exit code, one line on standard error when it goes wrong.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <iostream>
#include <new>
#include <optional>
#include <vector>

#include "isowave/error.h"
#include "base/heap.h"
#include "isowave/progress.h"
#include "tools/cli.h"
#include "tools/console.h"
#include "tools/help.h"
#include "tools/output.h"

namespace {

namespace tools = isowave::tools;

// Before anything is opened: a result never takes the place of what it is made from.
void refuseToReplaceInputs(const tools::Settings& settings) {
    const tools::Inputs inputs(settings.files);
    for (const auto& place : {settings.output, settings.sheet, settings.svg})
        if (place) inputs.refuse(*place);
    if (settings.jsonFile) inputs.refuse(*settings.jsonFile);
}

// One of them would silently take the place of the other.
void refuseOnePlaceForTwoResults(const tools::Settings& settings) {
    std::vector<std::filesystem::path> places;
    for (const auto& place : {settings.output, settings.sheet, settings.svg})
        if (place) places.push_back(*place);
    if (settings.jsonFile && *settings.jsonFile != "-") places.emplace_back(*settings.jsonFile);
    for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) tools::refuseSamePlace(places[j], places[i]);
}

int run(int argc, char** argv) {
    const tools::Invocation invocation = tools::parseCommandLine(argc, argv);
    const tools::Settings& settings = invocation.settings;
    tools::Console console(settings.quiet);
    if (!invocation.command) {
        console.print(invocation.version ? "isowave " ISOWAVE_VERSION "\n" : tools::overview());
        return 0;
    }
    if (settings.help) {
        console.print(tools::helpFor(*invocation.command));
        return 0;
    }
    refuseToReplaceInputs(settings);
    refuseOnePlaceForTwoResults(settings);
    std::optional<tbb::global_control> threads;
    if (settings.threads > 0)
        threads.emplace(tbb::global_control::max_allowed_parallelism,
                        static_cast<std::size_t>(settings.threads));
    const int code = invocation.command->run(settings, console);
    console.finish();
    return code;
}

int complain(int code, std::string message) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    std::cerr << "isowave: " << message << '\n';
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    isowave::setUpHeap();
    tools::installSignalHandlers();
    try {
        const int code = run(argc, argv);
        if (!std::cout.flush()) return complain(1, "standard output could not be written; is the disk full?");
        return code;
    } catch (const tools::UsageError& error) {
        return complain(2, error.what());
    } catch (const isowave::InputError& error) {
        return complain(3, error.what());
    } catch (const isowave::Cancelled&) {
        return complain(130, "interrupted; nothing was left behind");
    } catch (const isowave::OperationError& error) {
        return complain(1, error.what());
    } catch (const std::bad_alloc&) {
        return complain(1, "memory did not suffice; take fewer voxels or free some memory");
    } catch (const std::exception& error) {
        return complain(1, fmt::format("failed: {}", error.what()));
    }
}
