#include "tools/similar.h"

#include <algorithm>

namespace isowave::tools {

// rows: the distances of the last two, and of this prefix of a, to all prefixes of b.
std::size_t editDistance(std::string_view a, std::string_view b) {
    const std::size_t n = b.size();
    std::vector<std::size_t> beforeLast(n + 1), last(n + 1), now(n + 1);
    for (std::size_t j = 0; j <= n; ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        now[0] = i;
        for (std::size_t j = 1; j <= n; ++j) {
            const std::size_t change = last[j - 1] + (a[i - 1] != b[j - 1]);
            now[j] = std::min({last[j] + 1, now[j - 1] + 1, change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = std::min(now[j], beforeLast[j - 2] + 1);
        }
        std::swap(beforeLast, last);
        std::swap(last, now);
    }
    return last[n];
}

std::string_view similarTo(std::string_view word, const std::vector<std::string_view>& candidates) {
    const std::size_t most = std::max<std::size_t>(1, word.size() / 3);
    std::string_view best;
    std::size_t least = most + 1;
    for (const std::string_view candidate : candidates) {
        const std::size_t edits = editDistance(word, candidate);
        if (edits < least) best = candidate, least = edits;
    }
    if (!best.empty()) return best;
    const auto begins = [&](std::string_view candidate) { return candidate.starts_with(word); };
    if (std::count_if(candidates.begin(), candidates.end(), begins) != 1) return {};
    return *std::find_if(candidates.begin(), candidates.end(), begins);
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& candidates,
                       const std::string& help) {
    const std::string_view found = similarTo(word, candidates);
    return found.empty() ? "; see " + help : "; did you mean " + std::string(found) + "? See " + help;
}

}  // namespace isowave::tools
