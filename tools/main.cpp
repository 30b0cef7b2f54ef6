// isowave: one subcommand, one exit code, one line on standard error when it goes wrong.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <iostream>
#include <new>
#include <optional>
#include <vector>

#include "base/heap.h"
#include "isowave/error.h"
#include "isowave/progress.h"
#include "isowave/version.h"
#include "tools/cli.h"
#include "tools/console.h"
#include "tools/help.h"
#include "tools/output.h"

namespace {

namespace tools = isowave::tools;

// Before anything is opened: a result never takes the place of what it is made from, nor of another result.
void refuseToReplace(const tools::Command& command) {
    std::vector<std::filesystem::path> read = command.arguments;
    for (const auto& place : command.options().inputs()) read.push_back(place);
    const tools::Inputs inputs(read);
    const std::vector<std::filesystem::path> results = command.options().results();
    for (const auto& place : results) inputs.refuse(place);
    for (std::size_t i = 0; i < results.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) tools::refuseSamePlace(results[j], results[i]);
    command.refuseToReplaceWhatIsNoReport();
}

int run(int argc, char** argv) {
    const tools::Commands commands = tools::allCommands();
    const tools::Invocation invocation = tools::parseCommandLine(commands, argc, argv);
    tools::Console console(invocation.command && invocation.command->quiet);
    if (!invocation.command) {
        console.print(invocation.version ? "isowave " ISOWAVE_VERSION "\n" : tools::overview(commands));
        return 0;
    }
    tools::Command& command = *invocation.command;
    if (invocation.help) {
        console.print(tools::helpFor(command));
        return 0;
    }
    refuseToReplace(command);
    std::optional<tbb::global_control> threads;
    if (command.threads > 0)
        threads.emplace(tbb::global_control::max_allowed_parallelism,
                        static_cast<std::size_t>(command.threads));
    const int code = command.run(console);
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
    } catch (const isowave::UsageError& error) {
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
