// A small XML document as a tree, with the places in the file where its texts stand. Expat parses it.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isowave {

struct XmlElement {
    // Bytes [begin, end) of the document.
    struct Range {
        std::size_t begin = 0, end = 0;
    };
    std::string name;
    std::map<std::string, std::string> attributes;
    std::vector<XmlElement> children;
    std::vector<Range> texts;  // around and between the children, as they stand in the file

    std::string get(const std::string& attribute) const {
        const auto found = attributes.find(attribute);
        return found == attributes.end() ? std::string() : found->second;
    }
    // The first child of that name, or null.
    const XmlElement* child(std::string_view wanted) const;
};

struct XmlDocument {
    XmlElement root;
    // Where the element that ended the parse begins to hold text; nothing where the document was parsed to its end.
    std::optional<std::size_t> stoppedAt;
};

// stopAt: the name of an element behind which bytes follow that are no XML; the parse ends with its start tag. Returns nothing
// where the bytes end before the document does. Throws InputError: no well-formed XML (line), elements deeper than 64 in each other.
std::optional<XmlDocument> parseXml(std::string_view bytes, const std::string& name,
                                    std::string_view stopAt = "");

}  // namespace isowave
