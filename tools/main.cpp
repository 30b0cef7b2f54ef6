// isowave: one subcommand, one exit code, one line on standard error when it goes wrong.
#include <tbb/global_control.h>

#include <iostream>
#include <optional>
#include <vector>

#include "base/heap.h"
#include "isowave/version.h"
#include "tools/about.h"
#include "tools/cli.h"
#include "tools/console.h"
#include "tools/failure.h"
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
    tools::Console console(invocation.command ? invocation.command->talk : tools::Talk());
    if (!invocation.command) {
        console.print(!invocation.version  ? tools::overview(commands)
                      : invocation.verbose ? tools::verboseVersion()
                                           : "isowave " ISOWAVE_VERSION "\n");
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

int complain(const tools::Failure& failure) {
    std::cerr << "isowave: " << failure.message << '\n';
    return failure.exitCode;
}

}  // namespace

int main(int argc, char** argv) {
    isowave::setUpHeap();
    tools::installSignalHandlers();
    try {
        const int code = run(argc, argv);
        if (!std::cout.flush())
            return complain({1, "standard output could not be written; is the disk full?"});
        return code;
    } catch (...) {
        return complain(tools::failureOf(std::current_exception()));
    }
}
