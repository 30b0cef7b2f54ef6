#include "io/vtk/xml.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::size_t kDeepest = 64;
// Expat takes lengths as int.
constexpr std::size_t kPiece = std::size_t(1) << 24;

class TreeBuilder {
  public:
    TreeBuilder(XML_Parser parser, std::string_view stopAt) : parser_(parser), stopAt_(stopAt) {
        XML_SetUserData(parser, this);
        XML_SetElementHandler(parser, &TreeBuilder::onStart, &TreeBuilder::onEnd);
    }
    XmlDocument document;
    bool tooDeep = false;

  private:
    static void onStart(void* self, const XML_Char* name, const XML_Char** attributes) {
        static_cast<TreeBuilder*>(self)->start(name, attributes);
    }
    static void onEnd(void* self, const XML_Char*) { static_cast<TreeBuilder*>(self)->end(); }

    std::size_t here() const {
        return static_cast<std::size_t>(std::max<XML_Index>(0, XML_GetCurrentByteIndex(parser_)));
    }

    // The text of the innermost open element ends here.
    void endText() {
        if (!open_.empty() && here() > from_) open_.back()->texts.push_back({from_, here()});
    }

    void start(const XML_Char* name, const XML_Char** attributes) {
        endText();
        XmlElement element;
        element.name = name;
        for (; *attributes; attributes += 2) element.attributes[attributes[0]] = attributes[1];
        tooDeep = open_.size() >= kDeepest;
        XmlElement* const place = open_.empty() ? &document.root : &open_.back()->children.emplace_back();
        *place = std::move(element);
        open_.push_back(place);
        from_ = here() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_));
        const bool stops = !stopAt_.empty() && place->name == stopAt_;
        if (stops) document.stoppedAt = from_;
        if (stops || tooDeep) XML_StopParser(parser_, XML_FALSE);
    }

    void end() {
        endText();
        open_.pop_back();
        from_ = here() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_));
    }

    XML_Parser parser_;
    std::string_view stopAt_;
    // invariant: each is the last child of the one before, so that no vector with an open element in it grows.
    std::vector<XmlElement*> open_;
    std::size_t from_ = 0;  // where the text that is being passed over began
};

[[noreturn]] void refuse(const std::string& name, XML_Parser parser) {
    throw InputError(
        name, fmt::format("line {} of it is no XML: {}; it is damaged", XML_GetCurrentLineNumber(parser),
                          XML_ErrorString(XML_GetErrorCode(parser))));
}

}  // namespace

const XmlElement* XmlElement::child(std::string_view wanted) const {
    const auto found = std::find_if(children.begin(), children.end(),
                                    [&](const XmlElement& element) { return element.name == wanted; });
    return found == children.end() ? nullptr : &*found;
}

std::optional<XmlDocument> parseXml(std::string_view bytes, const std::string& name,
                                    std::string_view stopAt) {
    const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
        XML_ParserCreate(nullptr), &XML_ParserFree);
    TreeBuilder tree(parser.get(), stopAt);
    for (std::size_t at = 0; at < bytes.size(); at += kPiece) {
        const std::string_view piece = bytes.substr(at, kPiece);
        if (XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()), false) == XML_STATUS_OK)
            continue;
        if (tree.tooDeep)
            throw InputError(name, fmt::format("has XML elements deeper than {} in each other", kDeepest));
        if (tree.document.stoppedAt) return std::move(tree.document);
        refuse(name, parser.get());
    }
    if (XML_Parse(parser.get(), "", 0, true) != XML_STATUS_OK) return std::nullopt;
    return std::move(tree.document);
}

}  // namespace isowave
